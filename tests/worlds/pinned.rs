//! A seed makes the same world on every machine.

use glam::Vec3;
use tercet::scene::mesh::Mesh;
use tercet::worlds::{self, Model, Pathology};

use super::teapots::teapot_cloud;

/// Pinned: a change here means that worlds of an old version are not those of the new one, and
/// measurements cannot be compared.
#[test]
fn a_seed_makes_the_same_world_bit_for_bit() {
    assert_eq!(fingerprint(&worlds::power_plant(1, 0.1)), 0x4F9A_B5DC_2922_9400);
    assert_eq!(fingerprint(&worlds::city(1, 0.05)), 0x7D21_ECAD_A789_B971);
    assert_eq!(fingerprint(&worlds::satellites(1, 0.05)), 0xCB4E_00AB_DDE0_4CFB);
    assert_eq!(fingerprint(&worlds::factory(1, 0.05)), 0xFCEA_5D2A_D565_168D);
    assert_eq!(fingerprint(&worlds::fantasy(1, 0.1)), 0xA477_65D9_BB47_EB80);
    assert_eq!(fingerprint(&worlds::random(1, 200)), 0x1BD4_9AA3_F59C_BBE2);
    let pathological = Pathology::ALL.map(|kind| fingerprint(&worlds::pathological(kind)));
    assert_eq!(pathological.iter().fold(0, |all, one| all ^ one), 0xE606_8D5E_925C_6346);
    assert_eq!(fingerprint(&teapot_cloud(1, 2500)), 0xDA54_0911_3207_C149);
    assert_ne!(fingerprint(&worlds::power_plant(2, 0.1)), fingerprint(&worlds::power_plant(1, 0.1)));
}

/// Every bit of a model that is drawn.
fn fingerprint(model: &Model) -> u64 {
    let mut hash = Fnv::default();
    for level in model.meshes.iter().flat_map(Mesh::levels) {
        level.positions.iter().flat_map(Vec3::to_array).for_each(|c| hash.word(c.to_bits()));
        level.indices.iter().for_each(|&i| hash.word(i));
        hash.word(level.error.to_bits());
    }
    for object in &model.objects {
        hash.word(object.mesh as u32);
        object.world_from_object.to_cols_array().iter().for_each(|c| hash.word(c.to_bits()));
        [object.bounds.min, object.bounds.max]
            .iter()
            .flat_map(Vec3::to_array)
            .for_each(|c| hash.word(c.to_bits()));
        object.color.iter().for_each(|&c| hash.word(u32::from(c)));
    }
    hash.0
}

/// FNV-1a, whose constants are fixed for good, unlike the standard library's hashers.
pub(super) struct Fnv(pub(super) u64);

impl Default for Fnv {
    fn default() -> Self {
        Self(0xCBF2_9CE4_8422_2325)
    }
}

impl Fnv {
    pub(super) fn word(&mut self, word: u32) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x100_0000_01B3);
        }
    }
}
