//! The table of materials.

use super::albedos;
use super::bump_maps::NormalMaps;
use crate::scene::{
    self, Anisotropy, Channel, Maps, Material, Opacity, Principled, Reflectance, Scene, TextureId,
    distinct_ior,
};
use glam::{UVec4, Vec3};
use raystream_shaders::scene::bsdf::albedo;
use raystream_shaders::scene::bsdf::conductor::Conductor;
use raystream_shaders::scene::bsdf::layer_maps::{
    CHANNEL_BITS, COAT, COAT_ROUGHNESS, GRAIN, LayerMaps, SHEEN, SHEEN_ROUGHNESS, SPECULAR,
    SPECULAR_COLOUR, TRANSMISSION,
};
use raystream_shaders::scene::bsdf::layers::{
    BLEND, GRAIN_STEPS, Layers, MASK, ROTATION_BIT, STRENGTH_BIT, THIN,
};
use raystream_shaders::scene::bsdf::{self, MaterialKind};
use raystream_shaders::scene::texture::NO_TEXTURE;
use std::collections::BTreeMap;

/// The materials of a scene, then one for each of its quad lights; `places` says where each texture
/// lies.
pub fn table(scene: &Scene, places: &[u32]) -> Vec<bsdf::Material> {
    let lamps = scene.quad_lights.iter().map(|light| Material::emissive(light.radiance));
    scene.materials.iter().copied().chain(lamps).map(|material| pack(material, places)).collect()
}

/// Where the kernels find a texture.
fn place(texture: Option<TextureId>, places: &[u32]) -> u32 {
    texture.map_or(NO_TEXTURE, |texture| places[texture.0 as usize])
}

/// What principled materials have beside the [`table`], for each of a scene's; nothing where none
/// is principled. `normals` are their maps of normals. The albedos that they need are added to
/// `tables`.
pub fn layered(
    scene: &Scene,
    normals: &NormalMaps,
    places: &[u32],
    tables: &mut Tables,
) -> Vec<Layers> {
    if !scene.materials.iter().any(|material| material.principled().is_some()) {
        return Vec::new();
    }
    let layers = scene.materials.iter().zip(&normals.of_materials).map(|(material, normal)| {
        let Some(principled) = material.principled() else { return Layers::NONE };
        let maps = Maps { normal: *normal, ..principled.maps };
        layers(&Principled { maps, ..*principled }, tables, places)
    });
    layers.collect()
}

/// The textures of the layers of each material; nothing where no material has any that most have
/// not.
pub fn layer_maps(scene: &Scene, places: &[u32]) -> Vec<LayerMaps> {
    let maps = |material: &Material| material.principled().map(|principled| principled.maps);
    if !scene.materials.iter().filter_map(maps).any(|maps| maps.has_layers()) {
        return Vec::new();
    }
    let packed =
        |material| maps(material).map_or(LayerMaps::NONE, |maps| packed_maps(&maps, places));
    scene.materials.iter().map(packed).collect()
}

fn packed_maps(maps: &Maps, places: &[u32]) -> LayerMaps {
    let shares = [
        (maps.coat, COAT),
        (maps.coat_roughness, COAT_ROUGHNESS),
        (maps.sheen_roughness, SHEEN_ROUGHNESS),
        (maps.transmission, TRANSMISSION),
        (maps.specular, SPECULAR),
    ];
    let others =
        [(maps.anisotropy, GRAIN), (maps.sheen, SHEEN), (maps.specular_colour, SPECULAR_COLOUR)];
    let mut packed = LayerMaps::NONE;
    for (map, number) in shares {
        packed.textures[number as usize] = place(map.map(|map| map.texture), places);
        packed.channels |= map.map_or(0, |map| map.channel) << (CHANNEL_BITS * number);
    }
    for (map, number) in others {
        packed.textures[number as usize] = place(map, places);
    }
    packed.coat_normal = place(maps.coat_normal.map(|map| map.texture), places);
    packed.coat_normal_scale = maps.coat_normal.map_or(1.0, |map| map.scale);
    packed
}

/// Tables of albedos, one of a kind, behind each other.
pub struct Tables {
    /// The albedos of boundaries and of sheen, and metals, as far as there are any.
    pub rows: Vec<UVec4>,
    /// Rows from the albedos of surfaces to these.
    first: u32,
    /// Where the table of each index of refraction begins, by its bits.
    boundaries: BTreeMap<u32, u32>,
    sheen: Option<u32>,
}

impl Tables {
    /// None so far, behind the layers of so many materials.
    pub fn new(materials: u32) -> Self {
        Self {
            rows: Vec::new(),
            first: albedo::ROWS + materials * Layers::ROWS,
            boundaries: BTreeMap::new(),
            sheen: None,
        }
    }

    /// Adds a table; where it begins.
    fn add(&mut self, table: &[UVec4]) -> u32 {
        let first = self.first + self.rows.len() as u32;
        self.rows.extend(table);
        first
    }

    /// Rows from the albedos of surfaces to a metal.
    fn conductor(&mut self, metal: scene::Conductor) -> u32 {
        self.add(&bytemuck::cast::<Conductor, [UVec4; Conductor::ROWS as usize]>(Conductor {
            eta: metal.eta,
            k: metal.k,
            mean: albedos::of_conductor(metal.eta, metal.k),
            ..Conductor::default()
        }))
    }

    /// Rows from the albedos of surfaces to those of boundaries of this index of refraction.
    pub fn boundary(&mut self, ior: f32) -> u32 {
        let key = ior.to_bits();
        if let Some(&first) = self.boundaries.get(&key) {
            return first;
        }
        let first = self.add(&albedos::of_boundary(ior));
        self.boundaries.insert(key, first);
        first
    }

    fn sheen(&mut self, principled: &Principled) -> u32 {
        if principled.sheen == Vec3::ZERO {
            return 0;
        }
        match self.sheen {
            Some(first) => first,
            None => {
                let first = self.add(albedos::of_sheen());
                *self.sheen.insert(first)
            }
        }
    }
}

fn layers(principled: &Principled, tables: &mut Tables, places: &[u32]) -> Layers {
    let place_of = |texture: Option<TextureId>| place(texture, places);
    let channel = |map: Option<Channel>| map.map_or(0, |map| map.channel);
    let (opacity, alpha, cutoff) = match principled.opacity {
        Opacity::Opaque => (0, 1.0, 0.0),
        Opacity::Mask { alpha, cutoff } => (MASK, alpha, cutoff),
        Opacity::Blend { alpha } => (BLEND, alpha, 0.0),
    };
    let mut boundary_albedos = 0;
    // A thin one looks up what surfaces have.
    if principled.transmission > 0.0 && !principled.thin_walled {
        boundary_albedos = tables.boundary(distinct_ior(principled.ior));
    }
    Layers {
        specular: principled.specular,
        metallic: principled.metallic,
        roughness: principled.roughness,
        transmission: principled.transmission,
        roughness_map: place_of(principled.maps.roughness.map(|map| map.texture)),
        metallic_map: place_of(principled.maps.metallic.map(|map| map.texture)),
        normal_map: place_of(principled.maps.normal.map(|map| map.texture)),
        normal_scale: principled.maps.normal.map_or(1.0, |map| map.scale),
        channels: channel(principled.maps.roughness) | channel(principled.maps.metallic) << 8,
        boundary_albedos,
        sheen: principled.sheen,
        sheen_roughness: principled.sheen_roughness,
        coat: principled.coat,
        coat_roughness: principled.coat_roughness,
        sheen_albedos: tables.sheen(principled),
        flags: opacity | if principled.thin_walled { THIN } else { 0 } | grain(principled),
        alpha,
        cutoff,
        emission_map: place_of(principled.maps.emission),
        conductor: principled.conductor.map_or(0, |metal| tables.conductor(metal)),
    }
    .with_f90(principled.f90)
}

/// The bits of [`Layers::flags`] that say how anisotropic a material is.
fn grain(principled: &Principled) -> u32 {
    let steps = |share: f32| (share * GRAIN_STEPS as f32).round() as u32;
    let Anisotropy { strength, rotation } = principled.anisotropy;
    let turns = rotation / 360.0;
    steps(strength) << STRENGTH_BIT | steps(turns - turns.floor()).min(GRAIN_STEPS) << ROTATION_BIT
}

/// The material as the kernels read it.
fn pack(material: Material, places: &[u32]) -> bsdf::Material {
    let plain = bsdf::Material { ior: 1.0, texture: NO_TEXTURE, ..bsdf::Material::default() };
    match material {
        Material::Diffuse { reflectance: Reflectance::Colour(reflectance) } => {
            bsdf::Material { kind: MaterialKind::DIFFUSE, reflectance, ..plain }
        }
        Material::Diffuse { reflectance: Reflectance::Texture(texture) } => bsdf::Material {
            kind: MaterialKind::DIFFUSE,
            reflectance: Vec3::ONE,
            texture: places[texture.0 as usize],
            ..plain
        },
        Material::Mirror { reflectance } => {
            bsdf::Material { kind: MaterialKind::MIRROR, reflectance, ..plain }
        }
        Material::Dielectric { ior, transmittance, reflectance, .. } => bsdf::Material {
            kind: MaterialKind::DIELECTRIC,
            reflectance,
            transmittance,
            ior,
            ..plain
        },
        Material::Emissive { radiance, reflectance } => {
            bsdf::Material { kind: MaterialKind::DIFFUSE, reflectance, emission: radiance, ..plain }
        }
        Material::Principled(principled) => {
            let Principled { base_colour, emission, maps, .. } = principled;
            bsdf::Material {
                kind: MaterialKind::PRINCIPLED,
                reflectance: base_colour,
                texture: place(maps.base_colour, places),
                emission,
                ior: distinct_ior(principled.ior),
                ..plain
            }
        }
    }
}
