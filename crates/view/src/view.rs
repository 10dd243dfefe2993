//! Where on the screen the picture is, and which pixel is where.

/// A place of the picture on the screen: how large its pixels are and where its middle is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Points of the screen that a pixel is wide; None for as large as there is room.
    zoom: Option<f32>,
    /// From the middle of the room to that of the picture, in points.
    offset: [f32; 2],
}

/// How large pixels become at most, in points.
const LARGEST: f32 = 64.0;
/// Points that must stay in sight of a picture.
const IN_SIGHT: f32 = 32.0;

/// A rectangle in points: left, top, right, bottom.
pub type Rectangle = [f32; 4];

impl Default for View {
    /// As large as there is room.
    fn default() -> Self {
        Self { zoom: None, offset: [0.0; 2] }
    }
}

impl View {
    /// One pixel a point, in the middle.
    pub fn whole() -> Self {
        Self { zoom: Some(1.0), offset: [0.0; 2] }
    }

    /// How many points a pixel of a picture of `size` is wide in a `room`.
    pub fn zoom(&self, room: Rectangle, size: [u32; 2]) -> f32 {
        self.zoom.unwrap_or_else(|| fitting(room, size))
    }

    /// Where a picture of `size` is in a `room`.
    pub fn rectangle(&self, room: Rectangle, size: [u32; 2]) -> Rectangle {
        let zoom = self.zoom(room, size);
        let half = size.map(|side| 0.5 * zoom * side as f32);
        let middle = middle(room);
        let [x, y] = [0, 1].map(|axis| middle[axis] + self.offset[axis]);
        [x - half[0], y - half[1], x + half[0], y + half[1]]
    }

    /// The place in the picture, in pixels from its top left corner, that is at a point; outside of
    /// it, too.
    pub fn place(&self, room: Rectangle, size: [u32; 2], point: [f32; 2]) -> [f32; 2] {
        let zoom = self.zoom(room, size);
        let rectangle = self.rectangle(room, size);
        [0, 1].map(|axis| (point[axis] - rectangle[axis]) / zoom)
    }

    /// The pixel that is at a point, if one is.
    pub fn pixel(&self, room: Rectangle, size: [u32; 2], point: [f32; 2]) -> Option<[u32; 2]> {
        let place = self.place(room, size, point);
        let is_inside = |axis: usize| place[axis] >= 0.0 && place[axis] < size[axis] as f32;
        (is_inside(0) && is_inside(1)).then(|| place.map(|side| side as u32))
    }

    /// Where a place of the picture is on the screen.
    pub fn point(&self, room: Rectangle, size: [u32; 2], place: [f32; 2]) -> [f32; 2] {
        let zoom = self.zoom(room, size);
        let rectangle = self.rectangle(room, size);
        [0, 1].map(|axis| rectangle[axis] + zoom * place[axis])
    }

    /// Makes pixels `factor` times as wide; what is at `point` stays there.
    pub fn zoom_at(&mut self, room: Rectangle, size: [u32; 2], point: [f32; 2], factor: f32) {
        if !(factor.is_finite() && factor > 0.0) {
            return;
        }
        let place = self.place(room, size, point);
        let smallest = fitting(room, size).min(1.0) * 0.25;
        let zoom = (self.zoom(room, size) * factor).clamp(smallest, LARGEST);
        self.zoom = Some(zoom);
        let now = self.point(room, size, place);
        self.pan(room, size, [0, 1].map(|axis| point[axis] - now[axis]));
    }

    /// Moves the picture by so many points; a part of it stays in sight.
    pub fn pan(&mut self, room: Rectangle, size: [u32; 2], by: [f32; 2]) {
        let zoom = self.zoom(room, size);
        self.zoom = Some(zoom);
        let sides = [room[2] - room[0], room[3] - room[1]];
        for axis in [0, 1] {
            let reach = (0.5 * (sides[axis] + zoom * size[axis] as f32) - IN_SIGHT).max(0.0);
            self.offset[axis] = (self.offset[axis] + by[axis]).clamp(-reach, reach);
        }
    }
}

fn middle(room: Rectangle) -> [f32; 2] {
    [0.5 * (room[0] + room[2]), 0.5 * (room[1] + room[3])]
}

fn fitting(room: Rectangle, size: [u32; 2]) -> f32 {
    let [width, height] = size.map(|side| side.max(1) as f32);
    ((room[2] - room[0]) / width).min((room[3] - room[1]) / height).clamp(1e-3, LARGEST)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROOM: Rectangle = [100.0, 50.0, 900.0, 450.0];
    const SIZE: [u32; 2] = [400, 100];

    #[test]
    fn a_picture_fills_its_room_in_the_middle() {
        let view = View::default();
        assert_eq!(view.zoom(ROOM, SIZE), 2.0);
        assert_eq!(view.rectangle(ROOM, SIZE), [100.0, 150.0, 900.0, 350.0]);
        assert_eq!(View::whole().rectangle(ROOM, SIZE), [300.0, 200.0, 700.0, 300.0]);
    }

    #[test]
    fn points_and_pixels_are_inverse() {
        let mut view = View::default();
        view.zoom_at(ROOM, SIZE, [300.0, 200.0], 3.0);
        view.pan(ROOM, SIZE, [-40.0, 20.0]);
        for pixel in [[0, 0], [17, 99], [399, 3]] {
            let place = pixel.map(|side: u32| side as f32 + 0.5);
            let point = view.point(ROOM, SIZE, place);
            assert_eq!(view.pixel(ROOM, SIZE, point), Some(pixel));
        }
    }

    #[test]
    fn outside_there_is_no_pixel() {
        let view = View::default();
        for point in [[99.0, 200.0], [901.0, 200.0], [500.0, 149.0], [500.0, 350.5]] {
            assert_eq!(view.pixel(ROOM, SIZE, point), None, "{point:?}");
        }
        assert_eq!(view.pixel(ROOM, SIZE, [100.5, 150.5]), Some([0, 0]));
        assert_eq!(view.pixel(ROOM, SIZE, [899.5, 349.5]), Some([399, 99]));
    }

    #[test]
    fn what_is_under_the_pointer_stays_there() {
        let mut view = View::default();
        let point = [700.0, 300.0];
        let before = view.place(ROOM, SIZE, point);
        view.zoom_at(ROOM, SIZE, point, 1.7);
        let after = view.place(ROOM, SIZE, point);
        assert!(
            (0..2).all(|axis| (before[axis] - after[axis]).abs() < 1e-2),
            "{before:?} {after:?}"
        );
    }

    #[test]
    fn a_picture_is_never_lost() {
        let mut view = View::default();
        for _ in 0..99 {
            view.pan(ROOM, SIZE, [333.0, -777.0]);
            view.zoom_at(ROOM, SIZE, [120.0, 400.0], 0.5);
        }
        let [left, top, right, bottom] = view.rectangle(ROOM, SIZE);
        assert!(left < 900.0 && right > 100.0 && top < 450.0 && bottom > 50.0);
        assert!(right - left > 10.0);
        for factor in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let before = view;
            view.zoom_at(ROOM, SIZE, [0.0; 2], factor);
            assert_eq!(view, before);
        }
        assert!(View::default().zoom([0.0; 4], [0, 0]).is_finite());
    }
}
