//! The window, drawn by a software device without a screen.

#![allow(clippy::expect_used, clippy::unwrap_used, reason = "what fails is a test")]

use egui_kittest::{Harness, kittest::Queryable};
use raystream::scene::FilmSize;
use raystream_view::choices::Stops;
use raystream_view::desk::{Desk, Order};
use raystream_view::layers::Layer;
use raystream_view::news::Activity;
use raystream_view::stage::SceneChoice;
use raystream_view::thread::RenderThread;
use raystream_view::viewer::Viewer;
use raystream_view::window::Window;
use std::collections::HashSet;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A window of a small picture of the default scene, rendered on the CPU.
fn window() -> Window {
    let desk = Arc::new(Desk::new(|| ()));
    let size = Some(FilmSize { width: 40, height: 30 });
    let scene = SceneChoice { name: "cornell_ball".into(), size, ..SceneChoice::default() };
    let thread = RenderThread::start(Arc::clone(&desk), scene.clone()).unwrap();
    let stops = Stops { samples: Some(8), ..Stops::default() };
    let order = Order { stops, ..Order::new("cpu") };
    Window::new(Viewer::new(desk, scene, order), None).with_thread(thread)
}

/// None, and a word about it, where there is no device that draws.
fn harness() -> Option<Harness<'static, Window>> {
    let adapters = raystream::exec::devices::Devices::enumerate(Default::default()).list();
    if adapters.iter().all(|device| device.kind == "CPU") {
        let required = std::env::var_os("RAYSTREAM_REQUIRE_WINDOW").is_some();
        assert!(!required, "RAYSTREAM_REQUIRE_WINDOW is set, and there is no device that draws");
        eprintln!("NOT TESTED: the window, without a Vulkan device (mesa-vulkan-drivers)");
        return None;
    }
    let builder = Harness::builder().with_size([1000.0, 700.0]).wgpu();
    Some(builder.build_ui_state(|ui, window: &mut Window| window.draw(ui), window()))
}

/// Draws until the window is as wanted.
fn until(harness: &mut Harness<'_, Window>, is_wanted: impl Fn(&Viewer) -> bool) {
    let start = Instant::now();
    while !is_wanted(harness.state().viewer()) {
        let viewer = harness.state().viewer();
        assert!(start.elapsed() < Duration::from_secs(60), "{:?}", viewer.activity());
        std::thread::sleep(Duration::from_millis(5));
        harness.step();
    }
    // What has come is drawn with the next frame.
    harness.run_steps(3);
}

fn has_ended(viewer: &Viewer) -> bool {
    viewer.stop().is_some() && *viewer.activity() == Activity::Ended
}

/// The colours in the middle of where the picture is.
fn colors(harness: &mut Harness<'_, Window>) -> HashSet<[u8; 4]> {
    let image = harness.render().unwrap();
    let (width, height) = (image.width(), image.height());
    let inside = |x: u32, y: u32| {
        (width / 8..width / 2).contains(&x) && (height / 4..height * 3 / 4).contains(&y)
    };
    let pixels = image.enumerate_pixels().filter(|(x, y, _)| inside(*x, *y));
    pixels.map(|(_, _, pixel)| pixel.0).collect()
}

#[test]
fn a_picture_is_seen_and_layers_are_switched() {
    let Some(mut harness) = harness() else { return };
    until(&mut harness, has_ended);
    assert!(colors(&mut harness).len() > 100, "a picture has many colours");
    harness.get_by_label("Samples").click();
    harness.run_steps(3);
    assert_eq!(harness.state().viewer().layer(), Layer::Samples);
    assert!(harness.state().viewer().scale().is_some());
    assert!(colors(&mut harness).len() > 1);
    for layer in Layer::ALL {
        harness.get_by_label(layer.name()).click();
        until(&mut harness, has_ended);
        assert_eq!(harness.state().viewer().layer(), layer);
    }
}

#[test]
fn two_are_beside_each_other_by_a_key() {
    let Some(mut harness) = harness() else { return };
    until(&mut harness, has_ended);
    harness.key_press(egui::Key::C);
    until(&mut harness, |viewer| viewer.compares() && has_ended(viewer));
    assert!(harness.state().viewer().side(1).frame.is_some());
    harness.get_by_label("left");
    harness.get_by_label("right").click();
    harness.run_steps(2);
    assert_eq!(harness.state().viewer().chosen_side, 1);
    harness.key_press(egui::Key::C);
    harness.run_steps(2);
    assert!(!harness.state().viewer().compares());
}

#[test]
fn a_drag_orbits_and_a_click_keeps_a_pixel_with_its_path() {
    let Some(mut harness) = harness() else { return };
    until(&mut harness, has_ended);
    let (from, to) = (egui::pos2(300.0, 300.0), egui::pos2(380.0, 330.0));
    let before = harness.state().viewer().navigator().unwrap().camera();
    harness.drag_at(from);
    harness.run_steps(1);
    harness.hover_at(to);
    harness.run_steps(1);
    harness.drop_at(to);
    harness.run_steps(1);
    let after = harness.state().viewer().navigator().unwrap().camera();
    assert_ne!(before, after);
    until(&mut harness, |viewer| !viewer.order.moving && has_ended(viewer));
    assert!(harness.state().viewer().pinned.is_none(), "a drag is no click");
    harness.drag_at(from);
    harness.run_steps(1);
    harness.drop_at(from);
    harness.run_steps(1);
    assert!(harness.state().viewer().pinned.is_some());
    let rows = harness.state().viewer().inspected();
    assert!(rows.iter().any(|(name, value)| *name == "samples" && value != "0"), "{rows:?}");
    // The camera came to rest a moment ago: its picture, and the path with it, are yet to come.
    until(&mut harness, |viewer| viewer.path.drawing().is_some() && has_ended(viewer));
    let with_path = colors(&mut harness);
    harness.state_mut().viewer_mut().path.is_wanted = false;
    harness.run_steps(3);
    assert!(harness.state().viewer().path.drawing().is_none());
    assert_ne!(colors(&mut harness), with_path);
}

#[test]
fn what_goes_wrong_is_in_the_status_line() {
    let Some(mut harness) = harness() else { return };
    until(&mut harness, has_ended);
    harness.state_mut().viewer_mut().order.device = "no such device".to_owned();
    until(&mut harness, |viewer| matches!(viewer.activity(), Activity::Failed(_)));
    harness.get_by_label_contains("no such device");
}
