//! What things look like, and what is left out of a scene, with the reason.

use serde_json::json;
use tercet::scene::import;

use crate::shapes::numbered;
use crate::writer::{F32, U16, Writer};
use crate::{check_bounds, read, scenes};

#[test]
fn materials_give_colours_and_say_what_is_see_through() {
    let mut w = Writer::new();
    let p = w.positions(&scenes::FLAG);
    let materials = [
        json!({}),
        json!({ "pbrMetallicRoughness": { "baseColorFactor": [1.0, 0.5, 0.0, 1.0] }, "doubleSided": true }),
        json!({ "alphaMode": "MASK" }),
        json!({ "alphaMode": "BLEND" }),
        json!({ "extensions": { "KHR_materials_transmission": { "transmissionFactor": 0.5 } } }),
        json!({ "extensions": { "KHR_materials_pbrSpecularGlossiness": { "diffuseFactor": [0.0, 0.0, 1.0, 1.0] } } }),
    ];
    let primitives: Vec<_> = materials
        .into_iter()
        .map(|m| json!({ "attributes": { "POSITION": p }, "material": w.push("materials", m) }))
        .collect();
    let mesh = w.mesh("Swatches", primitives.into());
    w.root(json!({ "mesh": mesh }));
    let imported = read(&w);
    let looks: Vec<_> = imported.model.objects.iter().map(|o| (o.color, o.not_occluder)).collect();
    let white = [255; 3];
    let wanted = [
        (white, false),
        ([255, 188, 0], false),
        (white, true),
        (white, true),
        (white, true),
        ([0, 0, 255], false),
    ];
    assert_eq!(looks, wanted);
    assert_eq!(imported.report.meshes, 1, "one shape, six looks");
}

#[test]
fn what_is_not_a_surface_is_left_out_and_reported() {
    let mut w = Writer::new();
    let p = w.positions(&numbered(6));
    let empty = w.indices(U16, &[]);
    let hollow = w.push("accessors", json!({ "componentType": F32, "type": "VEC3", "count": 3 }));
    let part = |mode: u32| json!({ "attributes": { "POSITION": p }, "mode": mode });
    let mesh = w.mesh(
        "Lamp",
        json!([
            part(0), part(1), part(2), part(3), part(4),
            { "attributes": { "NORMAL": p } },
            { "attributes": { "POSITION": p }, "indices": empty },
            { "attributes": { "POSITION": hollow } },
            { "attributes": { "POSITION": p }, "targets": [{ "POSITION": p }] },
        ]),
    );
    w.mesh("Never used, and never read", json!([{ "attributes": { "POSITION": 999 } }]));
    w.root(json!({ "mesh": mesh }));
    w.root(json!({ "mesh": mesh, "name": "Far", "scale": [1e30, 1e30, 1e30], "translation": [3e38, 0, 0] }));
    w.root(json!({ "mesh": mesh, "skin": 0 }));
    w.push("scenes", json!({ "name": "Other", "nodes": [] }));
    let imported = read(&w);
    check_bounds(&imported);
    let far = imported.model.objects.iter().filter(|o| o.bounds.max.x > 1e30).count();
    let remarks = |list: &[import::Remark]| {
        list.iter().map(|r| format!("{}: {}", r.element, r.reason)).collect::<Vec<_>>()
    };
    assert_eq!(
        remarks(&imported.report.skipped),
        [
            "scene 1 'Other': the file's default scene is another",
            "mesh 0 'Lamp', primitive 0: it is made of points",
            "mesh 0 'Lamp', primitive 1: it is made of lines",
            "mesh 0 'Lamp', primitive 2: it is made of lines",
            "mesh 0 'Lamp', primitive 3: it is made of lines",
            "mesh 0 'Lamp', primitive 5: it has no positions",
            "mesh 0 'Lamp', primitive 6: it has no triangle",
            "mesh 0 'Lamp', primitive 7: its positions, accessor 2, have no data",
        ]
    );
    assert_eq!(far, 2, "3e38 + 5e30 is still a number");
    assert_eq!(
        remarks(&imported.report.altered),
        [
            "node 2: its skin is not applied: it stands as it was modelled",
            "mesh 0 'Lamp', primitive 8: its morph targets are not applied",
        ]
    );
    assert_eq!(imported.report.objects, 6);
}
