//! Where window and render thread meet: orders one way, news the other.

use crate::choices::{Choices, Stops};
use crate::news::{Activity, News};
use crate::stage::Stage;
use raystream::scene::Camera;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError, TryLockError};

/// What is to be rendered.
#[derive(Clone, Debug, PartialEq)]
pub struct Order {
    /// The device, as [`Device::open`](raystream::exec::Device::open) takes it.
    pub device: String,
    /// The camera; None for the scene's.
    pub camera: Option<Camera>,
    /// Whether the camera is moving, so that small pictures at once are wanted.
    pub moving: bool,
    /// What was chosen of each render; at least one. They get equal times.
    pub sides: Vec<Choices>,
    /// What ends them.
    pub stops: Stops,
    /// Whether to pause.
    pub paused: bool,
    /// Whether pictures should have all that can be computed of them.
    pub all: bool,
    /// With another number the scene is loaded anew.
    pub reload: u64,
}

impl Order {
    /// A first order: one render of the scene as its file says.
    pub fn new(device: &str) -> Self {
        Self {
            device: device.to_owned(),
            camera: None,
            moving: false,
            sides: vec![Choices::default()],
            stops: Stops::default(),
            paused: false,
            all: false,
            reload: 0,
        }
    }

    /// Whether what has been rendered for `other` is a part of what this wants.
    pub fn continues(&self, other: &Self) -> bool {
        let same_noise = self.stops.noise == other.stops.noise;
        let (stops, paused, all) = (other.stops, other.paused, other.all);
        same_noise && Self { stops, paused, all, ..self.clone() } == *other
    }
}

/// Where window and render thread meet.
pub struct Desk {
    orders: Mutex<Orders>,
    changed: Condvar,
    news: Mutex<News>,
    stage: Mutex<Option<Stage>>,
    wake: Box<dyn Fn() + Send + Sync>,
}

/// An order as it lies on the desk.
#[derive(Clone, Debug, PartialEq)]
pub struct Placed {
    /// What is wanted.
    pub order: Order,
    /// The number of the render, which stays where an order continues the one before.
    pub version: u64,
    /// The number of the order.
    pub number: u64,
}

#[derive(Default)]
struct Orders {
    latest: Option<Placed>,
    closing: bool,
}

impl Desk {
    /// A desk; `wake` is called whenever there are news.
    pub fn new(wake: impl Fn() + Send + Sync + 'static) -> Self {
        Self {
            orders: Mutex::default(),
            changed: Condvar::new(),
            news: Mutex::default(),
            stage: Mutex::default(),
            wake: Box::new(wake),
        }
    }

    /// Gives an order, if it is another than before. Returns the number of the render, which stays
    /// where that goes on.
    pub fn order(&self, order: &Order) -> u64 {
        let mut orders = lock(&self.orders);
        let placed = match orders.latest.take() {
            Some(latest) if latest.order == *order => latest,
            Some(latest) => Placed {
                version: latest.version + u64::from(!order.continues(&latest.order)),
                number: latest.number + 1,
                order: order.clone(),
            },
            None => Placed { order: order.clone(), version: 1, number: 1 },
        };
        let version = placed.version;
        orders.latest = Some(placed);
        self.changed.notify_all();
        version
    }

    /// Tells the thread to end.
    pub fn close(&self) {
        lock(&self.orders).closing = true;
        self.changed.notify_all();
    }

    /// The latest order; None once the window has closed, or before any order.
    pub fn latest(&self) -> Option<Placed> {
        let orders = lock(&self.orders);
        orders.latest.clone().filter(|_| !orders.closing)
    }

    /// Whether another render than that of this number is wanted, or none.
    pub fn is_outdated(&self, version: u64) -> bool {
        let orders = lock(&self.orders);
        orders.closing || orders.latest.as_ref().is_none_or(|latest| latest.version != version)
    }

    /// Waits for an order of another number than `known`; None once the window has closed.
    pub fn wait(&self, known: Option<u64>) -> Option<Placed> {
        let mut orders = lock(&self.orders);
        while !orders.closing && orders.latest.as_ref().map(|latest| latest.number) == known {
            orders = self.changed.wait(orders).unwrap_or_else(PoisonError::into_inner);
        }
        drop(orders);
        self.latest()
    }

    /// Adds to the news.
    pub fn tell(&self, add: impl FnOnce(&mut News)) {
        add(&mut lock(&self.news));
        (self.wake)();
    }

    /// Says what the thread is at.
    pub fn is_at(&self, activity: Activity) {
        let mut news = lock(&self.news);
        if news.activity != activity {
            news.activity = activity;
            drop(news);
            (self.wake)();
        }
    }

    /// The news since the last time.
    pub fn take_news(&self) -> News {
        lock(&self.news).take()
    }

    /// The same, if nobody has it at the moment.
    pub fn try_stage(&self) -> Option<MutexGuard<'_, Option<Stage>>> {
        match self.stage.try_lock() {
            Ok(stage) => Some(stage),
            Err(TryLockError::Poisoned(poisoned)) => Some(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => None,
        }
    }

    /// The scene, once there is one.
    pub fn stage(&self) -> MutexGuard<'_, Option<Stage>> {
        lock(&self.stage)
    }
}

/// What a thread that failed has left is whole: it is written at once.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use raystream::render::AllocatorKind;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::time::Duration;

    fn other_orders(order: &Order) -> Vec<Order> {
        let uniform = Choices { allocator: AllocatorKind::Uniform, ..order.sides[0] };
        vec![
            Order { device: "gpu".to_owned(), ..order.clone() },
            Order {
                camera: Some(Camera::new(glam::Vec3::Z, glam::Vec3::ZERO, 9.0)),
                ..order.clone()
            },
            Order { moving: true, ..order.clone() },
            Order { sides: vec![uniform], ..order.clone() },
            Order { sides: vec![order.sides[0], uniform], ..order.clone() },
            Order { stops: Stops { noise: Some(0.1), ..order.stops }, ..order.clone() },
            Order { reload: 1, ..order.clone() },
        ]
    }

    #[test]
    fn what_changes_the_picture_is_another_render_and_stops_are_not() {
        let desk = Desk::new(|| ());
        let order = Order::new("cpu");
        let first = desk.order(&order);
        assert_eq!(desk.order(&order), first);
        let stops = Stops { samples: Some(9), time: Some(Duration::MAX), noise: None };
        assert_eq!(desk.order(&Order { stops, ..order.clone() }), first);
        assert_eq!(desk.order(&Order { stops, paused: true, all: true, ..order.clone() }), first);
        assert!(!desk.is_outdated(first));
        for other in other_orders(&order) {
            let version = desk.order(&other);
            assert!(version > first, "{other:?}");
            assert!(desk.is_outdated(first));
            let back = desk.order(&order);
            assert!(back > version, "what was there is gone");
        }
    }

    /// Otherwise the thread would wait for ever where somebody has changed their mind.
    #[test]
    fn an_order_that_comes_back_is_another_one() {
        let desk = Desk::new(|| ());
        let order = Order::new("cpu");
        desk.order(&order);
        let first = desk.latest().unwrap();
        desk.order(&Order { moving: true, ..order.clone() });
        desk.order(&order);
        assert_eq!(desk.wait(Some(first.number)).unwrap().order, order);
    }

    #[test]
    fn waiting_ends_with_an_order_and_with_the_window() {
        let desk = Arc::new(Desk::new(|| ()));
        let waiter = {
            let desk = Arc::clone(&desk);
            std::thread::spawn(move || {
                let first = desk.wait(None);
                let known = first.as_ref().map(|first| first.number);
                (first, desk.wait(known))
            })
        };
        let order = Order::new("cpu");
        desk.order(&order);
        std::thread::sleep(Duration::from_millis(20));
        desk.close();
        let (first, second) = waiter.join().unwrap();
        assert_eq!(first, Some(Placed { order, version: 1, number: 1 }));
        assert_eq!(second, None);
        assert!(desk.is_outdated(1));
    }

    #[test]
    fn news_wake_the_window() {
        let woken = Arc::new(AtomicUsize::new(0));
        let counter = Arc::clone(&woken);
        let desk = Desk::new(move || {
            counter.fetch_add(1, Ordering::Relaxed);
        });
        desk.is_at(Activity::Loading);
        desk.is_at(Activity::Loading);
        assert_eq!(woken.load(Ordering::Relaxed), 1, "the same again is no news");
        desk.tell(|news| news.device = Some("a".to_owned()));
        assert_eq!(woken.load(Ordering::Relaxed), 2);
        assert_eq!(desk.take_news().device.as_deref(), Some("a"));
    }
}
