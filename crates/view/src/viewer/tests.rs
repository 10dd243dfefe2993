//! What a viewer shows, by a thread that renders small pictures.

use super::*;
use crate::choices::Stops;
use crate::thread::RenderThread;
use raystream::scene::FilmSize;

pub(super) fn viewer(name: &str) -> (Viewer, RenderThread) {
    let desk = Arc::new(Desk::new(|| ()));
    let size = Some(FilmSize { width: 32, height: 24 });
    let scene = SceneChoice { name: name.into(), size, ..SceneChoice::default() };
    let thread = RenderThread::start(Arc::clone(&desk), scene.clone()).unwrap();
    let stops = Stops { samples: Some(8), ..Stops::default() };
    let order = Order { stops, ..Order::new("cpu") };
    (Viewer::new(desk, scene, order), thread)
}

pub(super) fn until(viewer: &mut Viewer, is_wanted: impl Fn(&Viewer) -> bool) {
    let start = Instant::now();
    while !is_wanted(viewer) {
        assert!(start.elapsed() < Duration::from_secs(60), "{:?}", viewer.activity);
        viewer.update(Instant::now());
        std::thread::sleep(Duration::from_millis(2));
    }
}

pub(super) fn has_ended(viewer: &Viewer) -> bool {
    viewer.stop().is_some() && *viewer.activity() == Activity::Ended
}

#[test]
fn a_picture_comes_is_painted_and_ends() {
    let (mut viewer, _thread) = viewer("cornell_ball");
    until(&mut viewer, has_ended);
    assert_eq!(viewer.stop(), Some(Stop::Samples));
    let painted = viewer.take_painted(0).unwrap();
    assert_eq!((painted.size, painted.pixels.len()), ([32, 24], 32 * 24));
    assert!(painted.pixels.iter().any(|pixel| *pixel != painted.pixels[0]));
    assert!(!viewer.side(0).curve.points().is_empty());
    assert!(viewer.device().unwrap().starts_with("CPU"));
    viewer.show(Layer::Samples);
    viewer.update(Instant::now());
    assert_ne!(viewer.take_painted(0).unwrap(), painted);
    assert!(viewer.scale().unwrap().range().is_some());
    viewer.pointed = Some([3, 4]);
    assert!(viewer.inspected().contains(&("pixel", "3, 4".to_owned())));
}

#[test]
fn a_camera_that_moves_has_small_pictures_and_at_rest_a_whole_one() {
    let (mut viewer, _thread) = viewer("cornell_ball");
    until(&mut viewer, has_ended);
    viewer.navigate(Instant::now(), |navigator| navigator.orbit(0.3, 0.1));
    let wait = viewer.update(Instant::now()).unwrap();
    assert!(wait <= REST && viewer.order.moving);
    let is_small = |viewer: &Viewer| viewer.side(0).frame.as_ref().is_some_and(|f| f.moving);
    until(&mut viewer, is_small);
    assert_eq!(viewer.side(0).frame.as_ref().unwrap().film.width, 8);
    viewer.pointed = Some([31, 23]);
    assert!(viewer.inspected().contains(&("pixel", "7, 5".to_owned())));
    until(&mut viewer, |viewer| !is_small(viewer) && has_ended(viewer));
    assert!(!viewer.order.moving && viewer.order.camera.is_some());
    viewer.reset_camera();
    viewer.update(Instant::now());
    assert_eq!(viewer.order.camera, None, "it is the scene's own again");
}

#[test]
fn two_renders_are_beside_each_other_and_one_is_alone_again() {
    let (mut viewer, _thread) = viewer("cornell_ball");
    viewer.compare(true);
    until(&mut viewer, has_ended);
    assert_eq!(viewer.order.sides[1].allocator, AllocatorKind::Uniform);
    assert!(viewer.side(1).frame.is_some() && !viewer.side(1).curve.points().is_empty());
    assert_eq!((viewer.side_at(15.0), viewer.side_at(16.0)), (0, 1));
    viewer.compare(false);
    viewer.update(Instant::now());
    assert_eq!(viewer.side_at(31.0), 0);
    assert!(viewer.side(1).frame.is_none() && viewer.speedup().is_none());
}

#[test]
fn the_layer_without_noise_wants_a_filter() {
    let (mut viewer, _thread) = viewer("cornell_ball");
    viewer.show(Layer::Denoised);
    assert_eq!(viewer.order.sides[0].filter, Some(FilterKind::Auto));
    until(&mut viewer, has_ended);
    let frame = viewer.side(0).frame.as_ref().unwrap();
    assert!(frame.film.denoised.is_some());
}

#[test]
fn what_is_saved_is_there_and_what_cannot_be_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let (mut viewer, _thread) = viewer("cornell_ball");
    // It waits until there is a picture, and until that has all layers.
    viewer.order.stops.samples = None;
    for name in ["a.png", "a.exr"] {
        let path = folder.path().join(name);
        viewer.picture_path = path.display().to_string();
        viewer.save_picture();
        until(&mut viewer, |viewer| viewer.saved.is_some());
        assert!(matches!(&viewer.saved, Some(Saved::Done(_))), "{:?}", viewer.saved);
        assert!(path.is_file() && !viewer.is_saving());
    }
    let layers = raystream::image::read_layers(&folder.path().join("a.exr")).unwrap();
    assert!(layers.channel("plain.R").is_some(), "the picture is corrected");
    assert!(layers.channel("albedo.R").unwrap().iter().any(|albedo| *albedo > 0.0));
    viewer.picture_path = folder.path().join("none/a.png").display().to_string();
    viewer.save_picture();
    until(&mut viewer, |viewer| viewer.saved.is_some());
    assert!(matches!(&viewer.saved, Some(Saved::Failed(why)) if why.contains("none")));
    viewer.save_camera();
    assert!(
        matches!(&viewer.saved, Some(Saved::Failed(why)) if why.contains("cornell_ball")),
        "a scene that ships has no file"
    );
}

#[test]
fn a_file_that_changes_is_another_picture_and_a_wrong_one_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.json");
    let write = |green: &str| {
        let text = format!(
            r#"{{"format": 2, "name": "a", "film": {{"width": 32, "height": 24}},
            "camera": {{"origin": [0, 0, 4], "target": [0, 0, 0], "up": [0, 1, 0],
            "fov_y": 40}}, "background": [0.5, {green}, 0.5]}}"#
        );
        std::fs::write(&path, text).unwrap();
    };
    write("0.25");
    let (mut viewer, _thread) = viewer(path.to_str().unwrap());
    viewer.watch = Some(Watch::new(|| ()).unwrap());
    let color = |viewer: &Viewer| viewer.side(0).frame.as_ref().map(|f| f.film.color()[0].y);
    until(&mut viewer, |viewer| has_ended(viewer) && color(viewer) == Some(0.25));
    write("0.75");
    until(&mut viewer, |viewer| has_ended(viewer) && color(viewer) == Some(0.75));
    write("wrong");
    let failed = |viewer: &Viewer| matches!(viewer.activity(), Activity::Failed(_));
    until(&mut viewer, failed);
    let Activity::Failed(reason) = viewer.activity() else { panic!("it has failed") };
    assert!(reason.contains("a.json"), "{reason}");
    write("1");
    until(&mut viewer, |viewer| has_ended(viewer) && color(viewer) == Some(1.0));
}

#[test]
fn a_focus_is_what_is_at_the_place() {
    let (mut viewer, _thread) = viewer("cornell_ball");
    until(&mut viewer, has_ended);
    let before = viewer.navigator().unwrap().pivot();
    viewer.focus([5.0, 20.0]);
    assert_ne!(viewer.navigator().unwrap().pivot(), before);
    let version = viewer.version;
    viewer.update(Instant::now());
    assert_eq!(viewer.version, version, "a pinhole sees the same");
}
