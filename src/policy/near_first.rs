//! From near to far: what comes first hides what comes later, so that less of it is drawn.

use super::Context;
use crate::scene::ObjectId;

/// Orders objects from near to far; what hides nothing comes last. O(objects · log objects); `order` is room
/// to work.
pub(super) fn near_first(cx: &Context<'_>, objects: &mut Vec<ObjectId>, order: &mut Vec<(f32, ObjectId)>) {
    let (eye, store) = (cx.view.eye(), cx.scene.objects_store());
    let distance = |id: ObjectId| {
        let bounds = cx.tree.aabb_of(id.slot() as u32).filter(|_| store.is_occluder(id.slot() as u32));
        bounds.map_or(f32::INFINITY, |bounds| match eye.w {
            0.0 => -eye.truncate().dot(bounds.center()),
            _ => bounds.distance_squared(eye.truncate()),
        })
    };
    order.clear();
    order.extend(objects.drain(..).map(|id| (distance(id), id)));
    order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    objects.extend(order.iter().map(|&(_, id)| id));
}
