//! `raystream inspect`

use super::ending::{CliError, Ending};
use super::loading::LoadArguments;
use super::output::print_line;
use clap::Args;
use raystream::render::{BvhQuality, PreparedScene};
use raystream::scene::{Material, Mesh, Projection, Scene, Texels, Texture, TextureFilter, Wrap};
use serde_json::{Value, json};
use std::path::PathBuf;

/// The options of `raystream inspect`.
#[derive(Args)]
pub struct InspectArguments {
    /// A scene: a scene file, a glTF (.gltf, .glb), an OBJ, a PLY, the name of a scene that ships,
    /// or - for standard input.
    scene: PathBuf,
    /// Print JSON, for other programs.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    load: LoadArguments,
}

/// Prints what a scene holds.
pub fn run(arguments: &InspectArguments) -> Result<Ending, CliError> {
    let scene = arguments.load.load_silently(&arguments.scene, arguments.json)?;
    let prepared = PreparedScene::new(&scene, BvhQuality::Fast)?;
    if arguments.json {
        print_line(&serde_json::to_string_pretty(&as_json(&scene, &prepared))?)?;
    } else {
        for line in lines(&scene, &prepared) {
            print_line(&line)?;
        }
    }
    Ok(Ending::Done)
}

/// Kinds of materials, and how many of each a scene has.
fn materials(scene: &Scene) -> Vec<(&'static str, usize)> {
    let kind = |material: &Material| match material {
        Material::Diffuse { .. } => "diffuse",
        Material::Mirror { .. } => "mirror",
        Material::Dielectric { .. } => "dielectric",
        Material::Emissive { .. } => "emissive",
        Material::Principled(_) => "principled",
    };
    let count = |wanted| scene.materials.iter().filter(|m| kind(m) == wanted).count();
    let kinds = ["diffuse", "mirror", "dielectric", "emissive", "principled"];
    kinds.into_iter().map(|kind| (kind, count(kind))).filter(|(_, count)| *count > 0).collect()
}

/// How many triangles of meshes emit light.
fn emissive_triangles(scene: &Scene) -> usize {
    let emits = |material: &Material| material.radiance().max_element() > 0.0;
    let placed = scene.instances.iter().map(|instance| &scene.shapes[instance.shape.0 as usize]);
    let meshes = scene.meshes.iter().chain(placed);
    let lit = meshes.filter(|mesh| emits(&scene.materials[mesh.material.0 as usize]));
    lit.map(|mesh| mesh.triangles.len()).sum()
}

/// The lowest and highest corners of the box around all meshes; none without any.
fn bounds(scene: &Scene) -> Option<[[f32; 3]; 2]> {
    Some(scene.bounds()?.map(|corner| corner.to_array()))
}

/// Triangles of shapes that are once in memory, and as many as they would be if each instance had
/// its own.
fn instanced_triangles(scene: &Scene) -> [usize; 2] {
    let of_shape = |shape: &Mesh| shape.triangles.len();
    let placed = scene.instances.iter().map(|instance| &scene.shapes[instance.shape.0 as usize]);
    [scene.shapes.iter().map(of_shape).sum(), placed.map(of_shape).sum()]
}

/// Bytes on a device: of geometry, of surfaces, of textures with the environment.
fn memory(prepared: &PreparedScene) -> [u64; 3] {
    let PreparedScene { geometry, surfaces, texels, .. } = prepared;
    [size_of_val(&geometry[..]), size_of_val(&surfaces[..]), size_of_val(&texels[..])]
        .map(|bytes| bytes as u64)
}

fn wrap_name(wrap: Wrap) -> &'static str {
    match wrap {
        Wrap::Repeat => "repeat",
        Wrap::Clamp => "clamp",
        Wrap::Mirror => "mirror",
    }
}

fn projection_as_json(projection: &Projection) -> Value {
    match *projection {
        Projection::Perspective { fov_y, lens } => json!({
            "type": "perspective",
            "fov_y": fov_y,
            "lens": lens.map(|lens| json!({
                "radius": lens.radius,
                "focus_distance": lens.focus_distance,
                "blades": lens.blades,
            })),
        }),
        Projection::Orthographic { width } => json!({"type": "orthographic", "width": width}),
        Projection::Panorama => json!({"type": "panorama"}),
    }
}

/// The same in words.
fn projection_in_words(projection: &Projection) -> String {
    match *projection {
        Projection::Perspective { fov_y, lens: None } => format!("{fov_y} degrees high"),
        Projection::Perspective { fov_y, lens: Some(lens) } => format!(
            "{fov_y} degrees high, through a lens of radius {} in focus at {}",
            lens.radius, lens.focus_distance
        ),
        Projection::Orthographic { width } => format!("by parallel rays, {width} wide"),
        Projection::Panorama => "all around".to_owned(),
    }
}

fn as_json(scene: &Scene, prepared: &PreparedScene) -> Value {
    let camera = |camera: &raystream::scene::Camera| {
        json!({
            "origin": camera.origin.to_array(),
            "target": camera.target.to_array(),
            "up": camera.up.to_array(),
            "projection": projection_as_json(&camera.projection),
        })
    };
    let cameras = scene.cameras.iter().map(|named| {
        let mut value = camera(&named.camera);
        value["name"] = json!(named.name);
        value["film"] = json!([named.film.width, named.film.height]);
        value
    });
    let environment = scene
        .environment
        .as_ref()
        .map(|environment| json!({"width": environment.width, "height": environment.height}));
    let [geometry, surfaces, textures] = memory(prepared);
    let kinds: serde_json::Map<String, Value> =
        materials(scene).into_iter().map(|(kind, count)| (kind.to_owned(), json!(count))).collect();
    json!({
        "name": scene.name,
        "film": [scene.film.width, scene.film.height],
        "meshes": scene.meshes.len(),
        "triangles": scene.triangle_count(),
        "instances": {
            "shapes": scene.shapes.len(),
            "count": scene.instances.len(),
            "triangles": instanced_triangles(scene)[1],
            "triangles_of_shapes": instanced_triangles(scene)[0],
            "kept_as_such": prepared.instances,
        },
        "bounds": bounds(scene),
        "materials": kinds,
        "textures": scene.textures.iter().map(texture_as_json).collect::<Vec<_>>(),
        "lights": {
            "emissive_triangles": emissive_triangles(scene),
            "quads": scene.quad_lights.len(),
            "punctual": scene.punctual_lights.len(),
            "background": scene.background.to_array(),
            "environment": environment,
        },
        "camera": camera(&scene.camera),
        "camera_is_in_body": is_in_body(prepared),
        "cameras": cameras.collect::<Vec<_>>(),
        "variants": scene.variants,
        "memory": {"geometry": geometry, "surfaces": surfaces, "textures": textures},
        "warnings": scene.warnings.iter().cloned().chain(prepared.warnings()).collect::<Vec<_>>(),
        "details": scene.details,
    })
}

fn texture_as_json(texture: &Texture) -> Value {
    json!({
        "width": texture.width,
        "height": texture.height,
        "wrap": texture.wrap.map(wrap_name),
        "bits": match *texture.texels {
            Texels::Bytes(_) => 8,
            Texels::Shorts(_) => 16,
            Texels::Floats(_) => 32,
        },
        "filter": match texture.filter {
            TextureFilter::Linear => "linear",
            TextureFilter::Nearest => "nearest",
        },
    })
}

/// What there is of instances, if there are any.
fn instances(scene: &Scene, prepared: &PreparedScene) -> Option<String> {
    let ([once, all], count) = (instanced_triangles(scene), scene.instances.len());
    let repeated = match count - prepared.instances as usize {
        0 => String::new(),
        repeated => format!(" (but {repeated} are repeated or left out)"),
    };
    let shapes = scene.shapes.len();
    let text = format!(
        "instances   {count} of {shapes} shapes: {all} triangles, {once} in memory{repeated}"
    );
    (count > 0).then_some(text)
}

/// Whether the camera is in a body, where paths know what they are in.
fn is_in_body(prepared: &PreparedScene) -> bool {
    prepared.view().surfaces.media_of_camera().there() != 0
}

fn lines(scene: &Scene, prepared: &PreparedScene) -> Vec<String> {
    let mut lines = vec![
        format!("scene       {}, {}x{} pixels", scene.name, scene.film.width, scene.film.height),
        format!("triangles   {} in {} meshes", scene.triangle_count(), scene.meshes.len()),
    ];
    lines.extend(instances(scene, prepared));
    if let Some([[x0, y0, z0], [x1, y1, z1]]) = bounds(scene) {
        lines.push(format!("extent      ({x0}, {y0}, {z0}) to ({x1}, {y1}, {z1})"));
    }
    let kinds: Vec<_> =
        materials(scene).into_iter().map(|(kind, count)| format!("{count} {kind}")).collect();
    let none = |text: String| if text.is_empty() { "none".to_owned() } else { text };
    lines.push(format!("materials   {}", none(kinds.join(", "))));
    let texels: usize = scene.textures.iter().map(|texture| texture.texels.len()).sum();
    let largest = scene.textures.iter().max_by_key(|texture| texture.texels.len());
    lines.push(largest.map_or_else(
        || "textures    none".to_owned(),
        |largest| {
            format!(
                "textures    {} of {texels} texels together, the largest {}x{}",
                scene.textures.len(),
                largest.width,
                largest.height
            )
        },
    ));
    lines.push(format!("lights      {}", none(lights(scene).join(", "))));
    let raystream::scene::Camera { origin, target, projection, .. } = scene.camera;
    lines.push(format!(
        "camera      from ({}, {}, {}) to ({}, {}, {}), {}{}",
        origin.x,
        origin.y,
        origin.z,
        target.x,
        target.y,
        target.z,
        projection_in_words(&projection),
        if is_in_body(prepared) { ", in a body" } else { "" }
    ));
    for camera in &scene.cameras {
        let (name, film) = (&camera.name, camera.film);
        lines.push(format!("--camera    {name}: {}x{} pixels", film.width, film.height));
    }
    lines.extend(scene.variants.iter().map(|name| format!("--variant   {name}")));
    let [geometry, surfaces, textures] = memory(prepared).map(mebibytes);
    lines.push(format!(
        "memory      {geometry} of geometry, {surfaces} of surfaces, {textures} of textures"
    ));
    for warning in scene.warnings.iter().cloned().chain(prepared.warnings()) {
        lines.push(format!("not shown   {warning}"));
    }
    lines.extend(scene.details.iter().map(|detail| format!("detail      {detail}")));
    lines
}

fn lights(scene: &Scene) -> Vec<String> {
    let mut lights = Vec::new();
    let triangles = emissive_triangles(scene);
    if triangles > 0 {
        lights.push(format!("{triangles} triangles"));
    }
    if !scene.quad_lights.is_empty() {
        lights.push(format!("{} quads", scene.quad_lights.len()));
    }
    if !scene.punctual_lights.is_empty() {
        lights.push(format!("{} points, spots or suns", scene.punctual_lights.len()));
    }
    if scene.background.max_element() > 0.0 {
        lights.push("a background".to_owned());
    }
    if let Some(environment) = scene.environment.as_ref().filter(|found| found.emits()) {
        let (width, height) = (environment.width, environment.height);
        lights.push(format!("an environment of {width}x{height} texels"));
    }
    lights
}

/// A number of bytes, as people say it.
fn mebibytes(bytes: u64) -> String {
    format!("{:.1} MiB", bytes as f64 / f64::from(1 << 20))
}
