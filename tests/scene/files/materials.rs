//! Materials and textures of an MTL.

use super::{SQUARE, TEXTURED, assert_same, assert_warns, folder, loaded, scene};
use glam::{Vec2, Vec3};
use raystream::scene::{BumpMap, Material, NormalMap, Principled, TextureId, load};
use raystream_tests::scene_folder::MTL;

#[test]
fn paths_of_another_machine_lead_to_the_picture_beside() {
    let right = scene(SQUARE, TEXTURED);
    let with = |path: &str| scene(SQUARE, TEXTURED.replace("t.png", path));
    for path in
        ["C:\\scene\\maps\\t.png", "/srv/maps/t.png", "\\\\host\\share\\T.PNG", "../x/t.png"]
    {
        assert_same(&with(path), &right);
        assert_warns(&with(path), &["a.mtl", "lead nowhere", path, "`plain`"]);
    }
    assert_eq!(with("\"t.png\"").warnings, [""; 0]);
    assert_same(&with("\"t.png\""), &right);
    assert_same(&with("-s 1 1 1 \"C:\\my maps\\t.png\""), &right);
}

#[test]
fn options_of_a_texture_move_it() {
    let with = |options: &str| scene(SQUARE, TEXTURED.replace("t.png", options));
    let mapped = |change: fn(Vec2) -> Vec2| {
        let mut right = scene(SQUARE, TEXTURED);
        for corner in right.meshes[0].texture_coordinates.iter_mut().flatten().flatten() {
            *corner = change(*corner);
        }
        right
    };
    assert_same(&with("-s 4 2 1 t.png"), &mapped(|uv| uv * Vec2::new(4.0, 2.0)));
    assert_same(&with("-o 0.5 0.25 0 t.png"), &mapped(|uv| uv + Vec2::new(0.5, 0.25)));
    assert_same(&with("-o 0.5 -s 2 t.png"), &mapped(|uv| uv * Vec2::new(2.0, 1.0) + Vec2::X / 2.0));
    assert_eq!(with("-s 4 2 1 -clamp off t.png").warnings, [""; 0]);
    let clamped = with("-clamp on -mm 0.1 0.5 t.png");
    assert_warns(&clamped, &["a.mtl", "no effect", "`map_Kd -clamp`", "`map_Kd -mm`"]);
}

#[test]
fn a_grain_has_the_slopes_that_disneys_model_has() {
    let scene = scene(SQUARE, "newmtl plain\nPr 0.5\nPm 1\naniso 0.8\nanisor 0.25\n");
    let Material::Principled(found) = scene.materials[0] else { panic!("{:?}", scene.materials) };
    let across = found.roughness.powi(2);
    let along = across + (1.0 - across) * found.anisotropy.strength.powi(2);
    let aspect = (1.0_f32 - 0.9 * 0.8).sqrt();
    assert!((across - 0.25 * aspect).abs() < 1e-6 && (along - 0.25 / aspect).abs() < 1e-6);
    assert_eq!(found.anisotropy.rotation, 90.0);
    assert!(scene.meshes[0].texture_coordinates.is_some());
    assert_eq!(scene.warnings, [""; 0]);
    let bare = SQUARE.replace("f 1/1 2/2 3/3 4/4", "f 1 2 3 4");
    let bare = self::scene(bare, "newmtl plain\nPr 0.5\nPm 1\naniso 0.8\n");
    assert_warns(&bare, &["a.obj", "along what these are rougher", "`1 face` of `plain`"]);
}

#[test]
fn bump_maps_have_the_height_that_they_say() {
    let with = |lines: &str| {
        loaded(
            &folder(SQUARE, format!("newmtl plain\nKd 0 1 0\n{lines}"))
                .with("grey.png", picture([90, 90, 90]))
                .with("normals.png", picture([128, 127, 255])),
        )
    };
    let scene = with("map_Bump -bm 0.25 grey.png\n");
    let Material::Principled(found) = scene.materials[0] else { panic!("{:?}", scene.materials) };
    let bump = BumpMap { texture: TextureId(0), height: 0.25 };
    assert_eq!((found.maps.bump, found.base_colour), (Some(bump), Vec3::Y));
    assert_eq!((found.specular, found.maps.textures().count()), (Vec3::ZERO, 1));
    assert_eq!(scene.warnings, [""; 0]);
    // Both keys are written for programs that know one of them.
    let both = with("bump grey.png\nmap_bump -bm 0.25 grey.png\n");
    assert_same(&both, &scene);

    let metal = with("Pr 0.3\nPm 1\nbump -bm -2 grey.png\n");
    let Material::Principled(found) = metal.materials[0] else { panic!("{:?}", metal.materials) };
    assert_eq!((found.maps.bump.unwrap().height, found.metallic), (-2.0, 1.0));

    let normals = with("map_Bump -bm 0.5 normals.png\n");
    let Material::Principled(found) = normals.materials[0] else {
        panic!("{:?}", normals.materials)
    };
    let map = NormalMap { texture: TextureId(0), scale: 0.5 };
    assert_eq!((found.maps.normal, found.maps.bump), (Some(map), None));
    assert!(format!("{:?}", normals.details).contains("picture of normals"));

    for (lines, parts) in [
        ("bump grey.png\n", ["do not say by `-bm`", "`bump` of `plain`"]),
        ("bump -bm 1e9 grey.png\n", ["do not say by `-bm`", "`bump` of `plain`"]),
        ("bump -bm 1 gone.png\n", ["bump maps are not there", "gone.png` of `plain`"]),
        ("map_Kd -bm 2 grey.png\n", ["no effect", "`map_Kd -bm`"]),
        ("illum 3\nKs 1 1 1\nbump -bm 1 grey.png\n", ["no effect", "`bump` of `plain`"]),
    ] {
        assert_warns(&with(lines), &[&["a.mtl"], &parts[..]].concat());
    }
    let broken = folder(SQUARE, "newmtl plain\nKd 0 1 0\nbump -bm 1 t.png\n").with("t.png", "no");
    let broken = loaded(&broken);
    assert_eq!(broken.materials.len(), 1);
    assert_warns(&broken, &["bump maps cannot be read", "t.png"]);
}

/// A PNG of one texel.
fn picture(texel: [u8; 3]) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::RgbImage::from_pixel(1, 1, image::Rgb(texel))
        .write_to(&mut bytes, image::ImageFormat::Png)
        .unwrap();
    bytes.into_inner()
}

#[test]
fn pictures_that_cannot_be_read_are_as_those_that_are_not_there() {
    let gone = scene(SQUARE, TEXTURED.replace("t.png", "gone.png"));
    assert_eq!(gone.materials, [Material::diffuse(Vec3::Y)]);
    assert_warns(&gone, &["a.mtl", "not there", "`gone.png` of `plain`"]);
    let contents: [&[u8]; 4] =
        [b"GIF89a\x01\0\x01\0", b"RIFF\x04\0\0\0WEBPVP8 ", b"", b"\x89PNG\r\n\x1a\n"];
    for content in contents {
        let unreadable = loaded(&folder(SQUARE, TEXTURED).with("t.png", content));
        assert_same(&unreadable, &gone);
        assert_warns(&unreadable, &["a.mtl", "cannot be read", "t.png", "`plain`"]);
    }
}

#[test]
fn values_that_are_rounded_or_empty_are_no_errors() {
    let with = |mtl: &str| scene(SQUARE, format!("newmtl plain\n{mtl}"));
    let right = with("Kd 1 0.1 0\n");
    assert_same(&with("Kd 1.000001 0.1 -1e-9\n"), &right);
    assert_same(&with("Kd 1 .1 0\nillum\nKe\nNi \nmap_Kd\nTr\nd\n"), &right);
    assert_same(&with("Kd 1 .1 0\nKe -1e-9 0 0\n"), &right);
    assert_same(&with("Kd\n"), &with(""));
    let lamp = with("Ke 2 1 -0.000001\nKd 1.0001 0 0\n");
    let (radiance, reflectance) = (Vec3::new(2.0, 1.0, 0.0), Vec3::X);
    assert_eq!(lamp.materials, [Material::Emissive { radiance, reflectance }]);
    assert_warns(&with("Kd spectral blue.rfl 1\n"), &["no effect", "`Kd` of `plain`"]);
}

#[test]
fn the_number_of_illum_alone_makes_no_glass_of_paint() {
    let of = |mtl: &str| scene(SQUARE, format!("newmtl plain\nKd .8 .1 .1\n{mtl}")).materials[0];
    let paint = Material::diffuse(Vec3::new(0.8, 0.1, 0.1));
    for illum in [4, 6, 7, 9] {
        for rest in [
            "",
            "Ni 1\n",
            "d 1\n",
            "Tr 0\nNi 1.0000\n",
            "Ni 1\nTf 1 1 1\nd 1\n",
            "Tr 1\n",
            "Ni 1.5\nTf 0 0 0\n",
        ] {
            assert_eq!(of(&format!("illum {illum}\n{rest}")), paint, "{illum} {rest}");
        }
        let painted = of(&format!("illum {illum}\nNi 1.5\nd 1\nmap_Kd t.png\n"));
        assert!(painted.textures().next().is_some(), "{painted:?}");
        assert_eq!(of(&format!("illum {illum}\nNi 1.33\n")), Material::glass(1.33));
        assert_eq!(of(&format!("illum {illum}\nd 0.2\n")), Material::glass(1.5));
        assert_eq!(of(&format!("illum {illum}\nTr 0.8\nNi 1\n")), Material::glass(1.0));
        assert_eq!(of(&format!("illum {illum}\nTf .1 .6 .1\nNi 1.5\n")), Material::glass(1.5));
    }
    for illum in [3, 5] {
        assert_eq!(of(&format!("illum {illum}\n")), paint);
        assert_eq!(of(&format!("illum {illum}\nKs 0 0 0\n")), paint);
        assert_eq!(of(&format!("illum {illum}\nKs .9\n")), Material::mirror(Vec3::splat(0.9)));
    }
}

#[test]
fn the_keys_of_physically_based_materials() {
    let of = |mtl: &str| scene(SQUARE, format!("newmtl plain\nKd .8 .1 .1\n{mtl}"));
    let colour = Vec3::new(0.8, 0.1, 0.1);
    let material = |mtl: &str| of(mtl).materials[0];
    let is = |mtl: &str, expected: Principled| {
        assert_eq!(material(mtl), Material::Principled(expected), "{mtl}");
    };
    is("Pr 0.3\nPm 1\n", Principled::metal(colour, 0.3));
    is(
        "Pr 0.25\nNi 1.33\nKs .5\nNs 90\nillum 2\n",
        Principled { ior: 1.33, ..Principled::paint(colour, 0.25) },
    );
    is("Pm 1\nNs 250\n", Principled::metal(colour, 0.5));
    is("Pm 0.5\n", Principled { metallic: 0.5, ..Principled::paint(colour, 0.5) });
    let lamp = Principled { emission: Vec3::splat(2.0), ..Principled::paint(colour, 1.0) };
    is("Pr 1.001\nKe 2 2 2\n", lamp);
    let glass = Principled { transmission: 1.0, ..Principled::paint(colour, 0.2) };
    is("Pr 0.2\nillum 7\nNi 1.5\n", glass);
    assert_eq!(of("Pr 0.2\nillum 7\nNi 1.5\n").warnings, [""; 0]);
    assert_eq!(material("Pm 0\n"), Material::diffuse(colour), "no metal and no roughness");
    let painted = material("Pr 0.2\nmap_Kd t.png\n");
    assert!(matches!(painted, Material::Principled(Principled { roughness: 0.2, .. })));
    assert!(painted.textures().next().is_some());
    let folder = folder(SQUARE, "newmtl plain\nPr 1.5\n");
    let error = load(&folder.path("scene.json")).unwrap_err().to_string();
    assert!(error.contains("Pr") && error.contains("from 0 to 1, is 1.5"), "{error}");
}

/// A texture of emission multiplies `Ke`, or white; other paint becomes principled for it.
#[test]
fn textures_of_emission_are_shown() {
    let colour = Vec3::new(0.8, 0.1, 0.1);
    let of = |mtl: &str| {
        let mtl = format!("newmtl plain\nKd .8 .1 .1\n{mtl}");
        let scene = scene(SQUARE, &mtl);
        assert_eq!(scene.warnings, [""; 0], "{mtl}");
        let Material::Principled(material) = scene.materials[0] else {
            panic!("{mtl}: {:?}", scene.materials[0]);
        };
        assert!(material.maps.emission.is_some(), "{mtl}");
        material
    };
    let glowing = of("map_Ke t.png\n");
    assert_eq!((glowing.emission, glowing.base_colour), (Vec3::ONE, colour));
    assert_eq!((glowing.roughness, glowing.specular), (1.0, Vec3::ZERO));
    assert_eq!(of("Ke 3\nmap_Ke t.png\n").emission, Vec3::splat(3.0));
    assert_eq!(of("Ke 0 0 0\nmap_emissive t.png\n").emission, Vec3::ONE);
    let metal = of("Pr .2\nPm 1\nKe 2 1 0\nmap_Ke t.png\n");
    assert_eq!(
        (metal.roughness, metal.metallic, metal.emission),
        (0.2, 1.0, Vec3::new(2.0, 1.0, 0.0))
    );
    let both = of("map_Kd t.png\nmap_Ke t.png\n");
    assert_eq!(both.maps.base_colour, both.maps.emission);
    let gone = scene(SQUARE, "newmtl plain\nKe 2\nmap_Kd t.png\nmap_Ke gone.png\n");
    assert!(matches!(gone.materials[0], Material::Emissive { .. }), "{:?}", gone.materials);
    assert_warns(&gone, &["no effect", "`map_Kd` of `plain`"]);
    let moved = scene(SQUARE, "newmtl plain\nmap_Kd t.png\nmap_Ke -s 2 t.png\n");
    assert_eq!(moved.warnings, [""; 0]);
    let maps = moved.materials[0].principled().expect("it glows").maps;
    let at = |texture: Option<TextureId>| {
        let placement = moved.textures[texture.expect("one").0 as usize].placement;
        placement.of(Vec2::new(0.25, 0.5))
    };
    assert_eq!(at(maps.base_colour), Vec2::new(0.25, 0.5));
    assert_eq!(at(maps.emission), Vec2::new(0.5, 0.5));
}

#[test]
fn coats_and_sheen_arrive() {
    let scene = scene(SQUARE, "newmtl plain\nKd .8 .1 .1\nPr 0.3\nPc 1\nPcr 0.25\nPs 0.5\n");
    let Material::Principled(material) = scene.materials[0] else {
        panic!("{:?}", scene.materials[0]);
    };
    assert_eq!((material.coat, material.coat_roughness), (1.0, 0.25));
    assert_eq!(material.sheen, Vec3::splat(0.5));
    assert_eq!(scene.warnings, [""; 0]);
}

#[test]
fn what_is_left_out_is_said() {
    let with = |mtl: &str| scene(SQUARE, format!("newmtl plain\nKd .8 .1 .1\n{mtl}"));
    for (mtl, parts) in [
        ("d 0\n", ["opaque", "`d` of `plain`"]),
        ("Tr 1\n", ["opaque", "`Tr` of `plain`"]),
        ("d 1\nTr 1\n", ["no effect", "`Tr` of `plain`"]),
        ("map_d mask.png\n", ["opaque", "`map_d` of `plain`"]),
        ("map_Ke glow.png\n", ["textures of emission are not there", "`glow.png` of `plain`"]),
        ("illum 5\nKs 1\nmap_Ke t.png\n", ["emission by a texture", "`map_Ke` of `plain`"]),
        ("illum 4\nNi 1.5\nTf .1 .6 .1\n", ["filter", "`Tf` of `plain`"]),
        ("Ks .9 .9 .9\nNs 200\n", ["no effect", "`Ks` of `plain`; `Ns` of `plain`"]),
        ("norm n.png\nrefl r.png\n", ["no effect", "`norm` of `plain`; `refl` of `plain`"]),
        ("aniso 1\n", ["no effect", "`aniso` of `plain`"]),
        ("Pr 0.3\nmap_Pr r.png\nd 0.5\n", ["no effect", "`map_Pr` of `plain`"]),
        ("Ke 1 1 1\nmap_Kd t.png\n", ["no effect", "`map_Kd` of `plain`"]),
    ] {
        let scene = with(mtl);
        assert_warns(&scene, &[&["a.mtl"], parts.as_slice()].concat());
        assert!(scene.details.iter().any(|detail| detail.contains("a.mtl, line ")), "{scene:?}");
    }
    let nothing =
        "Ka 1 1 1\nKs 0 0 0\nNs 200\nd 1\nTr 0\nNi 1.5\nTf 1 1 1\nPm 0\nillum 2\nKe 0 0 0\n";
    assert_eq!(with(nothing).warnings, [""; 0]);
    let folder = folder(SQUARE, TEXTURED);
    image::RgbaImage::from_pixel(1, 1, image::Rgba([1, 1, 1, 0]))
        .save(folder.path("t.png"))
        .unwrap();
    assert_warns(&loaded(&folder), &["a.mtl", "opaque", "alpha of", "t.png", "`plain`"]);
    let obj =
        SQUARE.replace("v 2 0 0", "v 2 0 0 1 0 0") + "l 1 2\np 1\nfrob 1\ncurv 0 1 1 2\nfo 1 2 3\n";
    let scene = scene(obj, MTL);
    assert_warns(
        &scene,
        &["a.obj", "not read", "`curv`", "`frob` (1, the first is line 14)", "`l`", "`p`"],
    );
    assert_eq!(scene.triangle_count(), 3 + 2, "fo is an old name of f");
}
