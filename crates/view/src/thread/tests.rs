//! Orders, and the pictures that come of them.

use super::*;
use crate::choices::Choices;
use crate::news::News;
use glam::Vec3;
use raystream::render::{AllocatorKind, Stop};
use raystream::scene::Camera;

const SIZE: FilmSize = FilmSize { width: 32, height: 24 };

/// A thread that renders a small picture of a scene on the CPU, and the first order for it.
fn start(name: &str) -> (Arc<Desk>, RenderThread, Order) {
    let desk = Arc::new(Desk::new(|| ()));
    let scene = SceneChoice { name: name.into(), size: Some(SIZE), ..SceneChoice::default() };
    let thread = RenderThread::start(Arc::clone(&desk), scene).unwrap();
    (desk, thread, Order::new("cpu"))
}

/// The news, all together, until they are as wanted.
fn until(desk: &Desk, is_wanted: impl Fn(&News) -> bool) -> News {
    let (start, mut all) = (Instant::now(), News::default());
    while !is_wanted(&all) {
        assert!(start.elapsed() < Duration::from_secs(60), "{:?}", all.activity);
        let news = desk.take_news();
        all.activity = news.activity.clone();
        all.scene = news.scene.or(all.scene);
        all.device = news.device.or(all.device);
        all.points.extend(news.points);
        all.frames.extend(news.frames);
        std::thread::sleep(Duration::from_millis(2));
    }
    all
}

fn samples(number: u32) -> Stops {
    Stops { samples: Some(number), ..Stops::default() }
}

fn last(news: &News) -> &Frame {
    news.frames.last().unwrap()
}

#[test]
fn a_picture_ends_at_its_samples_and_goes_on_with_more() {
    let (desk, _thread, order) = start("cornell_ball");
    let version = desk.order(&Order { stops: samples(9), ..order.clone() });
    let news = until(&desk, |news| news.activity == Activity::Ended);
    let frame = last(&news);
    assert_eq!((frame.version, frame.side, frame.moving), (version, 0, false));
    assert_eq!((frame.film.width, frame.film.height), (32, 24));
    assert_eq!((frame.status.samples, frame.status.stop), (9.0, Some(Stop::Samples)));
    assert!(frame.status.rays > 9 * 32 * 24 && frame.status.error.is_some());
    assert!(frame.film.color().iter().any(|color| color.max_element() > 0.1));
    assert_eq!(news.scene.unwrap().size, SIZE);
    assert!(news.device.unwrap().starts_with("CPU"));
    assert_eq!(desk.order(&Order { stops: samples(12), ..order }), version);
    let news = until(&desk, |news| news.frames.last().is_some_and(|f| f.status.samples == 12.0));
    assert_eq!(last(&news).version, version, "it is the same render");
}

#[test]
fn the_picture_is_that_of_the_library() {
    let (desk, _thread, order) = start("cornell_ball");
    let choices = Choices { allocator: AllocatorKind::Uniform, ..Choices::default() };
    desk.order(&Order { sides: vec![choices], stops: samples(8), ..order });
    let shown = until(&desk, |news| news.activity == Activity::Ended);
    let mut scene = raystream::scene::load_named("cornell_ball").unwrap();
    scene.film = SIZE;
    let settings = choices.settings(&Settings::for_scene(&scene), None);
    let budget = raystream::render::Budget::samples(8);
    let film = raystream::render(&scene, &settings, budget, Device::open("cpu").unwrap()).unwrap();
    assert_eq!(last(&shown).film.radiance, film.radiance, "rounds are of no importance");
}

#[test]
fn another_camera_is_another_picture_and_a_moving_one_is_small() {
    let (desk, _thread, order) = start("cornell_ball");
    desk.order(&Order { stops: samples(4), ..order.clone() });
    let before = until(&desk, |news| news.activity == Activity::Ended);
    let camera = Camera::new(Vec3::new(0.3, 1.2, 3.0), Vec3::new(0.0, 1.0, 0.0), 40.0);
    let moving = Order { camera: Some(camera), moving: true, ..order.clone() };
    let version = desk.order(&moving);
    let news = until(&desk, |news| news.frames.iter().any(|f| f.version == version));
    let frame = last(&news);
    assert!(frame.moving && frame.film.width == 8 && frame.film.height == 6);
    assert!(news.points.iter().all(|(of, ..)| *of != version), "curves are of whole pictures");
    let still = Order { moving: false, stops: samples(4), ..moving };
    let version = desk.order(&still);
    let news =
        until(&desk, |n| n.frames.iter().any(|f| f.version == version && f.status.stop.is_some()));
    assert_eq!(last(&news).film.width, 32);
    assert_ne!(last(&news).film.position(), last(&before).film.position());
}

#[test]
fn two_renders_beside_each_other_get_equal_times() {
    let (desk, _thread, order) = start("cornell_ball");
    let uniform = Choices { allocator: AllocatorKind::Uniform, ..Choices::default() };
    let stops = Stops { time: Some(Duration::from_millis(1500)), ..Stops::default() };
    desk.order(&Order { sides: vec![Choices::default(), uniform], stops, ..order });
    let news = until(&desk, |news| news.activity == Activity::Ended);
    let end = |side| news.frames.iter().rfind(|f| f.side == side).unwrap().status;
    for status in [end(0), end(1)] {
        assert_eq!(status.stop, Some(Stop::Time));
        let seconds = status.time.as_secs_f64();
        assert!((1.5..3.0).contains(&seconds), "{seconds}");
        assert!(status.error.is_some());
    }
    // Neither is ever ahead by more than a round and a batch of the other.
    let mut times = [0.0; 2];
    for (_, side, status) in &news.points {
        times[*side] = status.time.as_secs_f64();
        assert!((times[0] - times[1]).abs() < 1.0, "{times:?}");
    }
}

#[test]
fn a_pause_holds_the_samples_and_lets_go() {
    let (desk, _thread, order) = start("cornell_ball");
    desk.order(&order);
    until(&desk, |news| !news.frames.is_empty());
    let version = desk.order(&Order { paused: true, ..order.clone() });
    until(&desk, |news| news.activity == Activity::Paused);
    desk.take_news();
    std::thread::sleep(Duration::from_millis(150));
    assert!(desk.take_news().frames.is_empty());
    assert_eq!(desk.order(&order), version);
    until(&desk, |news| news.activity == Activity::Rendering && !news.frames.is_empty());
}

#[test]
fn pictures_have_all_where_that_is_asked_for_and_at_rest() {
    let (desk, _thread, order) = start("cornell_ball");
    desk.order(&order);
    let news = until(&desk, |news| news.frames.len() > 2);
    assert!(news.frames.iter().all(|f| !f.all && f.film.corrections.is_none()));
    let version = desk.order(&Order { all: true, ..order.clone() });
    let news = until(&desk, |news| news.frames.iter().any(|frame| frame.all));
    let frame = news.frames.iter().find(|frame| frame.all).unwrap();
    assert_eq!(frame.version, version);
    assert!(frame.film.corrections.is_some() && frame.film.estimates.is_some());
    desk.order(&order);
    until(&desk, |news| news.frames.iter().any(|frame| !frame.all));
    desk.order(&Order { paused: true, ..order });
    until(&desk, |news| news.activity == Activity::Paused && last(news).all);
}

#[test]
fn what_goes_wrong_is_said_and_mended_by_another_order() {
    let (desk, _thread, order) = start("cornell_ball");
    desk.order(&Order { device: "no such device".to_owned(), ..order.clone() });
    let failed = |news: &News| matches!(news.activity, Activity::Failed(_));
    let news = until(&desk, failed);
    let Activity::Failed(reason) = news.activity else { panic!("it has failed") };
    assert!(reason.contains("no such device"), "{reason}");
    let nowhere = Camera::new(Vec3::ONE, Vec3::ONE, 40.0);
    desk.order(&Order { camera: Some(nowhere), ..order.clone() });
    let news = until(&desk, |news| failed(news) && news.device.is_some());
    let Activity::Failed(reason) = news.activity else { panic!("it has failed") };
    assert!(reason.contains("camera"), "{reason}");
    desk.order(&order);
    until(&desk, |news| !news.frames.is_empty());
}

#[test]
fn a_scene_that_is_not_there_is_named() {
    let (desk, _thread, order) = start("no_such_scene");
    desk.order(&order);
    let news = until(&desk, |news| matches!(news.activity, Activity::Failed(_)));
    let Activity::Failed(reason) = news.activity else { panic!("it has failed") };
    assert!(reason.contains("no_such_scene"), "{reason}");
}

#[test]
fn closing_ends_a_render_at_once() {
    let (desk, thread, order) = start("cornell_ball");
    desk.order(&order);
    until(&desk, |news| !news.frames.is_empty());
    let start = Instant::now();
    drop(thread);
    assert!(start.elapsed() < Duration::from_secs(1), "{:?}", start.elapsed());
}

#[test]
fn a_place_of_the_picture_is_a_point_of_the_scene() {
    let (desk, _thread, order) = start("cornell_ball");
    desk.order(&order);
    until(&desk, |news| !news.frames.is_empty());
    let stage = desk.stage();
    let stage = stage.as_ref().unwrap();
    let facts = stage.facts();
    let point = stage.pick(&facts.camera, SIZE, [16.0, 12.0]).unwrap();
    assert!((point - facts.bounds.centre).length() < 1.5 * facts.bounds.radius, "{point}");
    assert!(facts.triangles > 10);
}
