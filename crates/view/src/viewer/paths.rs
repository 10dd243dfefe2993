//! The path of a sample of the pixel that was clicked, over the picture.

use super::{Saved, Viewer};
use crate::inspect::{short, vector};
use crate::paths::{Drawing, SamplePath};
use raystream::render::IntegratorKind;

/// Which path is drawn.
#[derive(Clone, Copy, PartialEq)]
struct Wanted {
    version: u64,
    side: usize,
    pixel: [u32; 2],
    sample: u32,
}

/// The path that is drawn, and what is chosen of it.
pub struct ShownPath {
    /// Whether it is to be drawn.
    pub is_wanted: bool,
    /// Which of the pixel's samples it is of, from 1 on.
    pub sample: u32,
    drawn: Option<(Wanted, SamplePath, Drawing)>,
}

impl Default for ShownPath {
    fn default() -> Self {
        Self { is_wanted: true, sample: 1, drawn: None }
    }
}

impl ShownPath {
    /// How it lies over the picture, if there is one.
    pub fn drawing(&self) -> Option<&Drawing> {
        self.drawn.as_ref().map(|(_, _, drawing)| drawing)
    }
}

impl Viewer {
    /// How many samples the pixel has that was clicked: none while the camera moves, whose picture
    /// has other pixels.
    pub fn samples_of_pinned(&self) -> u32 {
        self.halves_of_pinned().map_or(0, |[first, second]| first + second)
    }

    fn halves_of_pinned(&self) -> Option<[u32; 2]> {
        let [x, y] = self.pinned?;
        let frame = self.side(self.side_at(x as f32)).frame.as_ref()?;
        let is_current = frame.version == self.version && !frame.moving;
        let film = &frame.film;
        if !is_current || x >= film.width || y >= film.height {
            return None;
        }
        let pixel = film.radiance.get((y * film.width + x) as usize)?;
        Some([pixel.first_samples, pixel.second_samples])
    }

    /// Traces the path that is to be drawn, if that is another one than before.
    pub(super) fn follow_path(&mut self) {
        let wanted = self.wanted_path();
        if wanted == self.path.drawn.as_ref().map(|(drawn, ..)| *drawn) {
            return;
        }
        self.path.drawn = wanted.and_then(|wanted| {
            let (path, drawing) = self.trace(&wanted)?;
            Some((wanted, path, drawing))
        });
    }

    fn wanted_path(&self) -> Option<Wanted> {
        let pixel = self.pinned.filter(|_| self.path.is_wanted)?;
        let last = self.samples_of_pinned().checked_sub(1)?;
        let sample = self.path.sample.saturating_sub(1).min(last);
        Some(Wanted { version: self.version, side: self.side_at(pixel[0] as f32), pixel, sample })
    }

    /// None where the render thread is about to have another camera on the stage: a picture by that
    /// follows, and this is asked for again.
    fn trace(&self, wanted: &Wanted) -> Option<(SamplePath, Drawing)> {
        let stage = self.desk.try_stage()?;
        let stage = stage.as_ref()?;
        let [first, _] = self.halves_of_pinned()?;
        let choices = self.order.sides.get(wanted.side)?;
        let settings = choices.settings(&stage.base(stage.facts().size), self.order.stops.noise);
        Some(stage.path(&settings, wanted.pixel, wanted.sample, first))
    }

    /// What is known of the path that is drawn.
    pub fn inspected_path(&self) -> Vec<(&'static str, String)> {
        let Some((wanted, path, _)) = &self.path.drawn else { return Vec::new() };
        let lights = path.vertices.iter().filter_map(|vertex| vertex.light);
        let open = lights.clone().filter(|light| light.is_open).count();
        let mut rows = vec![
            ("segments", path.segments().to_string()),
            ("lights seen", format!("{open} of {}", lights.count())),
        ];
        let integrator = self.order.sides.get(wanted.side).map(|side| side.integrator);
        // That has connections with paths from lights besides, which a round shares.
        if integrator != Some(IntegratorKind::Lvc) {
            rows.push(("its radiance", vector(path.contribution.radiance)));
        }
        if let Some(vertex) = path.vertices.last() {
            rows.push(("last vertex", vector(vertex.position)));
        }
        if let Some(ray) = path.escape {
            rows.push(("leaves along", ray.direction.to_array().map(short).join("  ")));
        }
        rows
    }

    /// Lets go of a pixel that the picture does not have.
    pub(super) fn check_pinned(&mut self) {
        let (Some([x, y]), Some(facts)) = (self.pinned, &self.facts) else { return };
        let (width, height) = (facts.size.width, facts.size.height);
        if x >= width || y >= height {
            self.pinned = None;
            self.saved = Some(Saved::Failed(format!(
                "there is no pixel {x},{y}: the picture has {width}x{height}, counted from 0,0"
            )));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{has_ended, until, viewer};
    use super::*;
    use std::time::{Duration, Instant};

    #[test]
    fn a_pixel_that_is_kept_has_its_path_over_the_picture() {
        let (mut viewer, _thread) = viewer("cornell_ball");
        until(&mut viewer, has_ended);
        assert!(viewer.path.drawing().is_none(), "none was clicked");
        viewer.pinned = Some([20, 18]);
        viewer.update(Instant::now());
        let [x, y] = viewer.path.drawing().unwrap().vertices[0].unwrap();
        assert!((x - 20.5).abs() <= 0.501 && (y - 18.5).abs() <= 0.501, "{x} {y}");
        let first = viewer.path.drawing().cloned();
        assert!(viewer.inspected_path().iter().any(|(name, _)| *name == "its radiance"));
        viewer.path.sample = 2;
        viewer.update(Instant::now());
        assert_ne!(viewer.path.drawing().cloned(), first, "another sample takes another path");
        viewer.path.is_wanted = false;
        viewer.update(Instant::now());
        assert!(viewer.path.drawing().is_none() && viewer.inspected_path().is_empty());
    }

    /// The samples of a pixel come to its picture: the paths are those of its samples.
    #[test]
    fn the_paths_of_all_samples_come_to_the_pixel() {
        let (mut viewer, _thread) = viewer("cornell_ball");
        until(&mut viewer, has_ended);
        viewer.pinned = Some([9, 20]);
        let (mut sum, samples) = (glam::DVec3::ZERO, viewer.samples_of_pinned());
        assert!(samples > 1, "{samples}");
        for sample in 1..=samples {
            viewer.path.sample = sample;
            viewer.update(Instant::now());
            let (_, path, _) = viewer.path.drawn.as_ref().unwrap();
            sum += path.contribution.radiance.as_dvec3();
        }
        let film = &viewer.side(0).frame.as_ref().unwrap().film;
        let of_film = film.radiance[20 * 32 + 9].sum().as_dvec3();
        // A sum of two numbers that were rounded to 24 bits each.
        assert!((sum - of_film).abs().cmple(of_film * 3e-7).all(), "{sum} {of_film}");
    }

    #[test]
    fn a_camera_that_moves_has_no_path_until_it_rests() {
        let (mut viewer, _thread) = viewer("cornell_ball");
        until(&mut viewer, has_ended);
        viewer.pinned = Some([20, 18]);
        viewer.update(Instant::now());
        let before = viewer.path.drawing().cloned();
        viewer.navigate(Instant::now(), |navigator| navigator.orbit(0.3, 0.1));
        viewer.update(Instant::now());
        assert!(viewer.path.drawing().is_none());
        std::thread::sleep(Duration::from_millis(300));
        until(&mut viewer, |viewer| has_ended(viewer) && viewer.path.drawing().is_some());
        assert_ne!(viewer.path.drawing().cloned(), before, "it is seen from another place");
    }

    #[test]
    fn a_pixel_that_is_not_in_the_picture_is_said() {
        let (mut viewer, _thread) = viewer("cornell_ball");
        viewer.pinned = Some([32, 3]);
        until(&mut viewer, has_ended);
        assert_eq!(viewer.pinned, None);
        let Some(Saved::Failed(reason)) = &viewer.saved else { panic!("nothing is said") };
        assert!(reason.contains("32,3") && reason.contains("32x24"), "{reason}");
    }
}
