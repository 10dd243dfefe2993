//! The schema that ships knows what the reader knows.

use super::{folder, whole};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};

const SCHEMA: &str = include_str!("../../../docs/scene.schema.json");

/// The keys that the reader knows where `at` is: it tells them to whoever gives another one.
fn keys_of_the_reader(at: &str) -> BTreeSet<String> {
    let mut scene = whole();
    if at == "/environment/sky" {
        scene["environment"]["sky"] = json!({});
    }
    if at == "/materials/glow/textures/bump" {
        scene["materials"]["glow"]["textures"]["bump"] = json!({});
    }
    if at == "/materials/glow/textures/emission/transform" {
        scene["materials"]["glow"]["textures"]["emission"]["transform"] = json!({});
    }
    // Alone, so that it is the first one that is read.
    *scene.pointer_mut(at).unwrap() = json!({"zzz": 0});
    if at.is_empty() {
        scene["format"] = json!(2);
        // Sorted by name, it would come after the others.
        scene = json!({"format": 2, "Zzz": 0});
    }
    let message = folder(&scene).error();
    let (_, known) = message.split_once("expected ").expect(&message);
    known.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

/// The schema knows the keys that the reader knows, and no others.
#[test]
fn the_schema_has_the_keys_of_the_reader() {
    let schema: Value = serde_json::from_str(SCHEMA).unwrap();
    let places: BTreeMap<&str, &str> = [
        ("", ""),
        ("/film", "film"),
        ("/camera", "camera"),
        ("/meshes/0", "mesh"),
        ("/meshes/0/transform", "transform"),
        ("/materials/wall", "material"),
        ("/materials/glow/reflectance", "colour_texture"),
        ("/materials/glow/textures", "textures"),
        ("/materials/glow/textures/roughness", "channel_texture"),
        ("/materials/glow/textures/normal", "normal_texture"),
        ("/materials/glow/textures/bump", "bump_texture"),
        ("/materials/glow/textures/emission", "plain_texture"),
        ("/materials/glow/textures/emission/transform", "texture_transform"),
        ("/quads/0", "quad"),
        ("/lights/0", "light"),
        ("/environment", "environment"),
        ("/environment/sky", "sky"),
        ("/integrator", "integrator"),
    ]
    .into();
    for (at, definition) in &places {
        let object =
            if definition.is_empty() { &schema } else { &schema["definitions"][definition] };
        assert_eq!(object["additionalProperties"], json!(false), "{definition}");
        let keys = object["properties"].as_object().unwrap().keys().cloned().collect();
        assert_eq!(keys_of_the_reader(at), keys, "{at}");
    }
    let definitions = schema["definitions"].as_object().unwrap();
    for (name, definition) in definitions {
        let is_looked_at = places.values().any(|known| known == name);
        assert!(is_looked_at || definition.get("properties").is_none(), "{name}");
    }
}

/// What the schema asks for, the reader asks for as well.
#[test]
fn what_is_required_is_missed() {
    let schema: Value = serde_json::from_str(SCHEMA).unwrap();
    for (at, definition) in [
        ("", ""),
        ("/film", "film"),
        ("/camera", "camera"),
        ("/quads/0", "quad"),
        ("/meshes/0", "mesh"),
        ("/materials/wall", "material"),
        ("/lights/0", "light"),
    ] {
        let object =
            if definition.is_empty() { &schema } else { &schema["definitions"][definition] };
        for key in object["required"].as_array().unwrap() {
            let mut scene = whole();
            let key = key.as_str().unwrap();
            scene.pointer_mut(at).unwrap().as_object_mut().unwrap().remove(key);
            let message = folder(&scene).error();
            assert!(message.contains("missing field") && message.contains(key), "{at}: {message}");
        }
    }
}
