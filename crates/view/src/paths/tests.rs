//! Paths in a box whose walls are known, against the integrator and its film.

use super::*;
use raystream::exec::Device;
use raystream::film::Film;
use raystream::render::scene::camera::camera as on_film;
use raystream::render::{Budget, BvhQuality, PreparedScene, Sampling, Settings};
use raystream::scene::{self, FilmSize, Material, Mesh, Projection, QuadLight, Scene};
use raystream_shaders::film::tiles::rank_of_pixel;
use raystream_shaders::integrator::megakernel::trace_slot;

const SIZE: FilmSize = FilmSize { width: 20, height: 20 };
/// Where the lamp of the box hangs.
const LAMP: f32 = 0.75;

/// The inside of a cube from -1 to 1, with a lamp below its ceiling, seen from its middle.
fn cube(wall: Material) -> Scene {
    let camera = scene::Camera::new(Vec3::ZERO, Vec3::NEG_Z, 90.0);
    let mut scene = Scene::new(camera, SIZE);
    let wall = scene.add_material(wall);
    for (u, v) in [(Vec3::X, Vec3::Y), (Vec3::Y, Vec3::Z), (Vec3::Z, Vec3::X)] {
        for out in [u.cross(v), v.cross(u)] {
            let corners = vec![out - u - v, out + u - v, out + u + v, out - u + v];
            scene.add_mesh(Mesh::new(wall, corners, vec![[0, 1, 2], [0, 2, 3]]));
        }
    }
    let corner = Vec3::new(-0.5, LAMP, -0.5);
    scene.add_quad_light(QuadLight::new(corner, Vec3::X, Vec3::Z, Vec3::splat(3.0)));
    scene
}

fn diffuse_cube() -> Scene {
    cube(Material::diffuse(Vec3::splat(0.7)))
}

struct Stage {
    prepared: PreparedScene,
    params: PathParams,
}

impl Stage {
    fn new(scene: &Scene, settings: &Settings) -> Self {
        let prepared = PreparedScene::new(scene, BvhQuality::High).unwrap();
        let params = prepared.parameters(settings);
        Self { prepared, params }
    }

    fn view(&self) -> SceneView<'_, Fixed<ALL>> {
        let PreparedScene { geometry, surfaces, texels, .. } = &self.prepared;
        SceneView::new(Fixed, &self.params.scene, geometry, surfaces, texels)
    }

    fn path(&self, [x, y]: [u32; 2], sample: u32) -> SamplePath {
        SamplePath::trace(&self.params, &self.view(), self.slot([x, y], sample))
    }

    fn slot(&self, [x, y]: [u32; 2], sample: u32) -> Slot {
        let Camera { width, height, .. } = self.params.camera;
        Slot { rank: rank_of_pixel(x, y, width, height), sample }
    }
}

fn pixels(size: FilmSize) -> impl Iterator<Item = [u32; 2]> {
    (0..size.height).flat_map(move |y| (0..size.width).map(move |x| [x, y]))
}

/// How far a point of the box is from what there is, if it is not on the lamp.
fn off_the_walls(point: Vec3) -> f32 {
    let on_lamp = (point.y - LAMP).abs() < 1e-5 && point.x.abs().max(point.z.abs()) <= 0.5001;
    if on_lamp { 0.0 } else { (point.abs().max_element() - 1.0).abs() }
}

#[test]
fn a_path_begins_in_its_pixel_and_has_its_vertices_on_surfaces() {
    let scene = diffuse_cube();
    let stage = Stage::new(&scene, &Settings::for_scene(&scene));
    let mut bounces = 0;
    for [x, y] in pixels(SIZE) {
        let path = stage.path([x, y], 0);
        assert_eq!(path.escape, None, "the box is closed");
        let drawing = path.drawing(&stage.params.camera, 9.0);
        let [px, py] = drawing.vertices[0].unwrap();
        let middle = [x, y].map(|side| side as f32 + 0.5);
        // The roundings of a point that is back-projected are far below a thousandth of a pixel.
        let is_inside = |at: f32, middle: f32| (at - middle).abs() <= 0.501;
        assert!(is_inside(px, middle[0]) && is_inside(py, middle[1]), "{x}, {y}: {px}, {py}");
        for vertex in &path.vertices {
            assert!(off_the_walls(vertex.position) < 1e-5, "{vertex:?}");
        }
        bounces += path.segments() - 1;
    }
    assert!(bounces > 400, "paths of walls that reflect 70 % are longer than {bounces} bounces");
}

#[test]
fn connections_end_at_the_lamp_and_are_open_where_it_is_seen() {
    let scene = diffuse_cube();
    let stage = Stage::new(&scene, &Settings::for_scene(&scene));
    let connections = pixels(SIZE).flat_map(|pixel| stage.path(pixel, 1).vertices);
    let connections: Vec<_> = connections.filter_map(|vertex| vertex.light).collect();
    assert!(connections.len() > 400);
    for connection in &connections {
        let to = end(&connection.segment, 9.0);
        assert!((to.y - LAMP).abs() < 1e-4 && to.x.abs().max(to.z.abs()) < 0.501, "{to}");
        assert!(connection.is_open, "nothing else is in the box: {connection:?}");
    }
    let mut scene = scene;
    let shade = scene.add_material(Material::diffuse(Vec3::splat(0.5)));
    let corner = Vec3::new(-0.9, 0.7, -0.9);
    let corners = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Z, Vec3::Z].map(|at| corner + at * 1.8);
    scene.add_mesh(Mesh::new(shade, corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]));
    let shaded = Stage::new(&scene, &Settings::for_scene(&scene));
    let below = |vertex: &Vertex| vertex.position.y < 0.5;
    let vertices = pixels(SIZE).flat_map(|pixel| shaded.path(pixel, 1).vertices);
    let hidden: Vec<_> = vertices.filter(below).filter_map(|vertex| vertex.light).collect();
    // From beside the board, a tenth from the walls, some of the lamp is seen.
    assert!(hidden.iter().filter(|light| !light.is_open).count() * 2 > hidden.len());
}

fn film(scene: &Scene, settings: &Settings, samples: u32) -> Film {
    let cpu = Device::open("cpu").unwrap();
    raystream::render(scene, settings, Budget::samples(samples), cpu).unwrap()
}

/// The film's sums are exact, and of one sample each here.
#[test]
fn paths_are_those_that_the_film_is_made_of() {
    let size = FilmSize { width: 12, height: 9 };
    let lens = Some(scene::Lens { radius: 0.1, focus_distance: 2.0, blades: 5 });
    let scenes = [
        diffuse_cube(),
        cube(Material::mirror(Vec3::splat(0.9))),
        scene::load_named("cornell_ball").unwrap(),
        scene::load_named("cornell_glass").unwrap(),
        scene::load_named("daylight").unwrap(),
        Scene {
            camera: scene::Camera {
                projection: Projection::Perspective { fov_y: 70.0, lens },
                ..diffuse_cube().camera
            },
            ..diffuse_cube()
        },
    ];
    for mut scene in scenes {
        scene.film = size;
        let sampling = Sampling { halves: true, ..Sampling::UNIFORM };
        let settings = Settings { sampling, seed: 5, ..Settings::for_scene(&scene) };
        let film = film(&scene, &settings, 2);
        let stage = Stage::new(&scene, &settings);
        for (pixel, sums) in pixels(size).zip(&film.radiance) {
            assert_eq!((sums.first_samples, sums.second_samples), (1, 1));
            let [first, second] = [0, 1].map(|s| stage.path(pixel, sample_number(s, 1)));
            let (a, b) = (first.contribution, second.contribution);
            let of_film = (sums.first_sum, sums.second_sum, sums.rays);
            assert_eq!(
                (a.radiance, b.radiance, a.rays + b.rays),
                of_film,
                "{} {pixel:?}",
                scene.name
            );
        }
    }
}

#[test]
fn a_path_has_the_rays_and_the_radiance_of_its_slot() {
    let scene = scene::load_named("tea").unwrap();
    let scene = Scene { film: SIZE, ..scene };
    let stage = Stage::new(&scene, &Settings::for_scene(&scene));
    for pixel in pixels(SIZE) {
        let path = stage.path(pixel, 3);
        let of_slot = trace_slot(&stage.params, &stage.view(), stage.slot(pixel, 3));
        assert_eq!(path.contribution, of_slot);
        let lights = path.vertices.iter().filter(|vertex| vertex.light.is_some()).count();
        assert_eq!(path.segments() + lights, of_slot.rays as usize);
    }
}

#[test]
fn samples_are_counted_half_by_half() {
    assert_eq!(sample_number(0, 1), 0);
    assert_eq!(sample_number(2, 3), 2);
    assert_eq!(sample_number(3, 3), SECOND_HALF);
    assert_eq!(sample_number(7, 3), SECOND_HALF | 4);
}

/// A path of the given vertices.
fn through(positions: &[Vec3], escape: Option<Ray>) -> SamplePath {
    let vertex = |position: &Vec3| Vertex { position: *position, light: None };
    let vertices = positions.iter().map(vertex).collect();
    SamplePath { lens: [0.5; 2], vertices, escape, contribution: Contribution::NOTHING }
}

fn of(projection: Projection) -> Camera {
    let camera = scene::Camera::new(Vec3::ZERO, Vec3::NEG_Z, 90.0);
    on_film(&scene::Camera { projection, ..camera }, SIZE)
}

fn pinhole() -> Camera {
    of(Projection::Perspective { fov_y: 90.0, lens: None })
}

fn assert_ends(line: &Line, expected: [[f32; 2]; 2]) {
    let pairs = line.ends.as_flattened().iter().zip(expected.as_flattened());
    assert!(pairs.clone().all(|(a, b)| (a - b).abs() < 1e-2), "{line:?} is not {expected:?}");
}

#[test]
fn lines_are_cut_where_the_picture_ends() {
    let (inside, beside) = (Vec3::new(0.0, 0.0, -1.0), Vec3::new(2.0, 0.0, -1.0));
    let drawing = through(&[inside, beside], None).drawing(&pinhole(), 9.0);
    assert_eq!(drawing.vertices, [Some([10.0, 10.0]), None]);
    assert_ends(&drawing.lines[0], [[10.0, 10.0], [20.0, 10.0]]);
    let across = [Vec3::new(-4.0, 0.5, -1.0), Vec3::new(4.0, 0.5, -1.0)];
    let drawing = through(&across, None).drawing(&pinhole(), 9.0);
    assert_ends(&drawing.lines[0], [[0.0, 5.0], [20.0, 5.0]]);
    let past = [Vec3::new(-4.0, 1.5, -1.0), Vec3::new(4.0, 1.5, -1.0)];
    assert_eq!(through(&past, None).drawing(&pinhole(), 9.0).lines, []);
}

#[test]
fn what_is_behind_the_camera_is_not_drawn() {
    let (ahead, behind) = (Vec3::new(0.0, 0.0, -1.0), Vec3::new(1.0, 0.0, 1.0));
    for (path, from) in [([ahead, behind], 0), ([behind, ahead], 1)] {
        let drawing = through(&path, None).drawing(&pinhole(), 9.0);
        assert_eq!(drawing.vertices[1 - from], None);
        let ends = [[10.0, 10.0], [20.0, 10.0]];
        assert_ends(&drawing.lines[0], if from == 0 { ends } else { [ends[1], ends[0]] });
    }
    let all = through(&[behind, behind + Vec3::Y], None).drawing(&pinhole(), 9.0);
    assert_eq!((all.lines.len(), all.vertices), (0, vec![None, None]));
}

#[test]
fn what_leaves_the_scene_is_drawn_a_part_of_the_way() {
    let from = Vec3::new(0.0, 0.0, -2.0);
    let escape = Some(Ray::new(from, Vec3::X));
    let drawing = through(&[from], escape).drawing(&pinhole(), 1.0);
    assert_ends(&drawing.lines[0], [[10.0, 10.0], [15.0, 10.0]]);
    assert_eq!(drawing.lines[0].part, Part::Escape);
    let nothing = through(&[], Some(Ray::new(Vec3::ZERO, Vec3::NEG_Z))).drawing(&pinhole(), 1.0);
    assert_eq!(nothing, Drawing::default(), "a segment from the camera is a point");
}

#[test]
fn parallel_rays_see_lines_as_they_are() {
    let camera = of(Projection::Orthographic { width: 4.0 });
    let ends = [Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 1.0, -5.0)];
    let drawing = through(&ends, None).drawing(&camera, 9.0);
    assert_ends(&drawing.lines[0], [[5.0, 10.0], [15.0, 5.0]]);
}

/// Behind the camera is where the picture's left and right sides meet.
#[test]
fn a_line_around_a_panorama_leaves_at_one_side_and_comes_in_at_the_other() {
    let camera = of(Projection::Panorama);
    let ends = [Vec3::new(1.0, 0.0, 1.0), Vec3::new(-1.0, 0.0, 1.0)];
    let drawing = through(&ends, None).drawing(&camera, 9.0);
    let x = |line: &Line| line.ends.map(|[x, _]| x);
    let reaches = |side: f32| drawing.lines.iter().any(|line| x(line).contains(&side));
    assert!(reaches(0.0) && reaches(20.0), "{drawing:?}");
    let length: f32 = drawing.lines.iter().map(|line| (x(line)[1] - x(line)[0]).abs()).sum();
    assert!((length - 5.0).abs() < 1e-2, "a quarter of the way around is {length} of 20 pixels");
    assert!(
        drawing.lines.iter().all(|line| line.ends.iter().all(|[_, y]| (y - 10.0).abs() < 1e-2))
    );
}
