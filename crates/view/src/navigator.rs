//! A camera in somebody's hands: it orbits, flies, comes nearer, and looks where it is told to.

use glam::{DQuat, DVec3};
use raystream::scene::{Camera, Projection};

/// Where the middle of the scene is, and how far it reaches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The middle, in world units.
    pub centre: DVec3,
    /// From there to the farthest corner, in world units; above 0.
    pub radius: f64,
}

impl Bounds {
    /// The bounds of these points; those of one or none have the radius 1.
    pub fn of(points: impl Iterator<Item = DVec3>) -> Self {
        let mut ends: Option<(DVec3, DVec3)> = None;
        for point in points {
            let (low, high) = ends.unwrap_or((point, point));
            ends = Some((low.min(point), high.max(point)));
        }
        let (low, high) = ends.unwrap_or_default();
        let radius = 0.5 * (high - low).length();
        let radius = if radius > 0.0 && radius.is_finite() { radius } else { 1.0 };
        Self { centre: 0.5 * (low + high), radius }
    }
}

/// A camera and the point that it turns around.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Navigator {
    camera: Camera,
    pivot: DVec3,
    bounds: Bounds,
}

/// The smallest angle between the view and up, in radians: nearer to the pole a camera would tip
/// over.
const POLE: f64 = 0.02;
/// Nearest and farthest that a camera comes to what it turns around, in radii of the scene.
const DISTANCES: std::ops::RangeInclusive<f64> = 1e-4..=1e3;

impl Navigator {
    /// A camera that turns around what is in the middle of its picture, as far away as its target,
    /// or as the middle of the scene if that is farther ahead than the target.
    pub fn new(camera: Camera, bounds: Bounds) -> Self {
        let origin = camera.origin.as_dvec3();
        let to_target = camera.target.as_dvec3() - origin;
        let forward = to_target.normalize_or(DVec3::NEG_Z);
        // Files often have a target right before the camera, which says a direction alone.
        let ahead = (bounds.centre - origin).dot(forward);
        let is_far = to_target.length() > 0.05 * bounds.radius;
        let distance = if is_far { to_target.length() } else { ahead.max(0.2 * bounds.radius) };
        Self { camera, pivot: origin + forward * distance, bounds }
    }

    /// The camera as it is.
    pub fn camera(&self) -> Camera {
        self.camera
    }

    /// The point that it turns around, in world units.
    pub fn pivot(&self) -> DVec3 {
        self.pivot
    }

    /// Turns around the pivot: `across` to the right and `down`, in radians, as a hand turns a
    /// ball. The camera stays as far away, and upright.
    pub fn orbit(&mut self, across: f64, down: f64) {
        let turn = self.turn(across, down);
        let origin = self.camera.origin.as_dvec3();
        let looks_at = self.camera.target.as_dvec3();
        let moved = |point: DVec3| self.pivot + turn * (point - self.pivot);
        self.set(moved(origin), moved(looks_at));
    }

    /// Looks around from where it is: `right` and `up`, in radians.
    pub fn look(&mut self, right: f64, up: f64) {
        let turn = self.turn(right, -up);
        let origin = self.camera.origin.as_dvec3();
        self.pivot = origin + turn * (self.pivot - origin);
        self.set(origin, origin + turn * (self.camera.target.as_dvec3() - origin));
    }

    /// Moves along its own axes, right, up and forward, in world units; the pivot comes along.
    pub fn fly(&mut self, step: DVec3) {
        let [right, up, forward] = self.axes();
        self.shift(right * step.x + up * step.y + forward * step.z);
    }

    /// Moves across the view so that what is as far away as the pivot follows a pointer which goes
    /// `right` and `down`, in parts of the picture's height.
    pub fn pan(&mut self, right: f64, down: f64) {
        let [to_right, up, _] = self.axes();
        let height = self.height_at_pivot();
        self.shift(up * (down * height) - to_right * (right * height));
    }

    /// Comes `factor` times as near to the pivot (2 halves the distance), or makes what parallel
    /// rays see as much narrower.
    pub fn zoom(&mut self, factor: f64) {
        if !(factor.is_finite() && factor > 0.0) {
            return;
        }
        if let Projection::Orthographic { width } = &mut self.camera.projection {
            *width = (f64::from(*width) / factor).clamp(1e-6, 1e9) as f32;
            return;
        }
        let origin = self.camera.origin.as_dvec3();
        let away = origin - self.pivot;
        let (least, most) = (DISTANCES.start(), DISTANCES.end());
        let radius = self.bounds.radius;
        let distance = (away.length() / factor).clamp(least * radius, most * radius);
        self.shift_without_pivot(self.pivot + away.normalize_or(DVec3::Z) * distance - origin);
    }

    /// Turns around `point` from now on, and has its lens in focus there, if it has one. The
    /// picture does not move.
    pub fn focus(&mut self, point: DVec3) {
        let [_, _, forward] = self.axes();
        let ahead = (point - self.camera.origin.as_dvec3()).dot(forward);
        if !point.is_finite() || ahead <= 0.0 {
            return;
        }
        self.pivot = point;
        if let Projection::Perspective { lens: Some(lens), .. } = &mut self.camera.projection {
            lens.focus_distance = (ahead as f32).clamp(f32::MIN_POSITIVE, 1e9);
        }
    }

    /// A speed for flying, in world units a second: through the scene in some seconds, slower near
    /// what it turns around.
    pub fn speed(&self) -> f64 {
        let distance = (self.camera.origin.as_dvec3() - self.pivot).length();
        distance.clamp(0.05 * self.bounds.radius, self.bounds.radius)
    }

    /// How high a picture is at the pivot, in world units.
    fn height_at_pivot(&self) -> f64 {
        let [_, _, forward] = self.axes();
        let ahead = (self.pivot - self.camera.origin.as_dvec3()).dot(forward).abs();
        match self.camera.projection {
            Projection::Perspective { fov_y, .. } => {
                2.0 * ahead * (0.5 * f64::from(fov_y).to_radians()).tan()
            }
            Projection::Orthographic { width } => f64::from(width),
            Projection::Panorama => std::f64::consts::PI * ahead,
        }
    }

    /// A turn about the camera's upward axis and its right one, which stays off the poles.
    fn turn(&self, right: f64, down: f64) -> DQuat {
        let up = self.camera.up.as_dvec3().normalize();
        let [to_right, _, forward] = self.axes();
        let from_up = forward.angle_between(up);
        let (right, down) = (finite(right), finite(down));
        let down = down.clamp(POLE - from_up, std::f64::consts::PI - POLE - from_up);
        DQuat::from_axis_angle(up, -right) * DQuat::from_axis_angle(to_right, -down)
    }

    /// To the right, up and ahead in the picture; unit length.
    fn axes(&self) -> [DVec3; 3] {
        let Camera { origin, target, up, .. } = self.camera;
        let forward = (target.as_dvec3() - origin.as_dvec3()).normalize_or(DVec3::NEG_Z);
        let right = forward.cross(up.as_dvec3()).normalize_or(DVec3::X);
        [right, right.cross(forward), forward]
    }

    fn shift(&mut self, by: DVec3) {
        if by.is_finite() {
            self.pivot += by;
            self.shift_without_pivot(by);
        }
    }

    fn shift_without_pivot(&mut self, by: DVec3) {
        self.set(self.camera.origin.as_dvec3() + by, self.camera.target.as_dvec3() + by);
    }

    /// Puts the camera somewhere else, unless a float would not see the difference between where
    /// it is and what it looks at.
    fn set(&mut self, origin: DVec3, target: DVec3) {
        let view = (target - origin).normalize_or_zero();
        let reach = (self.pivot - origin).length().max((target - origin).length());
        let camera = Camera {
            origin: origin.as_vec3(),
            target: (origin + view * reach).as_vec3(),
            ..self.camera
        };
        let is_far = origin.abs().max_element() > 1e8;
        if !is_far && view != DVec3::ZERO && camera.origin.distance(camera.target) > 0.0 {
            self.camera = camera;
        }
    }
}

fn finite(number: f64) -> f64 {
    if number.is_finite() { number } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use raystream::scene::Lens;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn bounds() -> Bounds {
        Bounds { centre: DVec3::ZERO, radius: 2.0 }
    }

    fn navigator() -> Navigator {
        Navigator::new(Camera::new(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, 90.0), bounds())
    }

    fn close(a: Vec3, b: Vec3) {
        assert!((a - b).length() < 1e-5, "{a} {b}");
    }

    #[test]
    fn bounds_are_those_of_the_points() {
        let corners = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(3.0, 2.0, -1.0)];
        let bounds = Bounds::of(corners.into_iter());
        assert_eq!(bounds.centre, DVec3::new(2.0, 2.0, 1.0));
        assert!((bounds.radius - 5_f64.sqrt()).abs() < 1e-12);
        assert_eq!(Bounds::of(std::iter::empty()).radius, 1.0);
    }

    #[test]
    fn a_quarter_turn_is_a_quarter_turn_and_four_come_back() {
        let mut navigator = navigator();
        navigator.orbit(FRAC_PI_2, 0.0);
        // The scene follows the hand to the right, so the camera goes to the left.
        close(navigator.camera().origin, Vec3::new(-4.0, 0.0, 0.0));
        close(navigator.camera().target, Vec3::ZERO);
        for _ in 0..3 {
            navigator.orbit(FRAC_PI_2, 0.0);
        }
        close(navigator.camera().origin, Vec3::new(0.0, 0.0, 4.0));
    }

    #[test]
    fn orbiting_stays_off_the_poles_and_keeps_the_distance() {
        let mut navigator = navigator();
        for step in 0..200 {
            navigator.orbit(0.3, if step < 100 { 0.5 } else { -0.7 });
            let camera = navigator.camera();
            let view = (camera.target - camera.origin).normalize();
            assert!(view.dot(camera.up).abs() < 0.999_9, "{camera:?}");
            assert!((camera.origin.length() - 4.0).abs() < 1e-3, "{camera:?}");
        }
    }

    #[test]
    fn dragging_down_looks_from_above() {
        let mut navigator = navigator();
        navigator.orbit(0.0, 0.5);
        assert!(navigator.camera().origin.y > 1.0, "{:?}", navigator.camera());
    }

    #[test]
    fn looking_around_keeps_the_place() {
        let mut navigator = navigator();
        navigator.look(FRAC_PI_2, 0.0);
        let camera = navigator.camera();
        close(camera.origin, Vec3::new(0.0, 0.0, 4.0));
        close((camera.target - camera.origin).normalize(), Vec3::X);
        navigator.look(0.0, 0.3);
        let camera = navigator.camera();
        assert!((camera.target - camera.origin).y > 0.0);
    }

    #[test]
    fn flying_moves_the_pivot_and_zooming_does_not() {
        let mut navigator = navigator();
        navigator.fly(DVec3::new(1.0, 2.0, 3.0));
        close(navigator.camera().origin, Vec3::new(1.0, 2.0, 1.0));
        assert_eq!(navigator.pivot(), DVec3::new(1.0, 2.0, -3.0));
        navigator.zoom(2.0);
        close(navigator.camera().origin, Vec3::new(1.0, 2.0, -1.0));
        assert_eq!(navigator.pivot(), DVec3::new(1.0, 2.0, -3.0));
    }

    #[test]
    fn what_is_at_the_pivot_follows_a_pan() {
        let mut navigator = navigator();
        // 90 degrees at distance 4: the picture is 8 high there.
        navigator.pan(0.25, 0.0);
        close(navigator.camera().origin, Vec3::new(-2.0, 0.0, 4.0));
        navigator.pan(0.0, 0.25);
        close(navigator.camera().origin, Vec3::new(-2.0, 2.0, 4.0));
    }

    #[test]
    fn zooming_stops_before_the_pivot_and_at_the_horizon() {
        let mut navigator = navigator();
        (0..1000).for_each(|_| navigator.zoom(1.5));
        assert!(navigator.camera().origin.z > 1e-4);
        (0..1000).for_each(|_| navigator.zoom(0.5));
        assert!(navigator.camera().origin.z < 3000.0);
        let before = navigator.camera();
        for factor in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            navigator.zoom(factor);
        }
        assert_eq!(navigator.camera(), before);
    }

    #[test]
    fn a_focus_moves_the_lens_and_the_pivot_but_not_the_picture() {
        let lens = Lens { radius: 0.1, focus_distance: 9.0, blades: 0 };
        let mut camera = Camera::new(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, 90.0);
        camera.projection = Projection::Perspective { fov_y: 90.0, lens: Some(lens) };
        let mut navigator = Navigator::new(camera, bounds());
        navigator.focus(DVec3::new(1.0, 1.0, 1.0));
        let focused = navigator.camera();
        assert_eq!((focused.origin, focused.target), (camera.origin, camera.target));
        // Along the view, and not along the ray.
        let Projection::Perspective { lens: Some(lens), .. } = focused.projection else {
            panic!("it has a lens")
        };
        assert_eq!(lens.focus_distance, 3.0);
        assert_eq!(navigator.pivot(), DVec3::ONE);
        navigator.focus(DVec3::new(0.0, 0.0, 5.0));
        assert_eq!(navigator.pivot(), DVec3::ONE, "what is behind is no focus");
    }

    #[test]
    fn a_target_right_before_the_camera_is_a_direction() {
        let camera = Camera::new(Vec3::new(0.0, 0.0, 4.0), Vec3::new(0.0, 0.0, 3.99), 40.0);
        let navigator = Navigator::new(camera, bounds());
        assert!((navigator.pivot() - DVec3::ZERO).length() < 1e-5, "{}", navigator.pivot());
        assert_eq!(navigator.camera(), camera, "nothing has moved");
    }

    #[test]
    fn strange_numbers_change_nothing_for_the_worse() {
        let mut navigator = navigator();
        for number in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e300] {
            navigator.orbit(number, number);
            navigator.look(number, number);
            navigator.fly(DVec3::splat(number));
            navigator.pan(number, number);
            navigator.focus(DVec3::splat(number));
        }
        let camera = navigator.camera();
        assert!(camera.origin.is_finite() && camera.target.is_finite(), "{camera:?}");
        assert!(camera.origin != camera.target);
        navigator.orbit(PI, 0.0);
        assert!(navigator.camera().origin.is_finite());
    }
}
