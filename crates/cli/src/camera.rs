//! The options that change a scene's camera.

use clap::Args;
use raystream::scene::{Camera, Lens, Projection};

/// The options that change a scene's camera.
#[derive(Args)]
pub struct CameraArguments {
    /// Give a perspective camera a lens of this radius, in the scene's units: its focal length over
    /// twice the f-number. What is not in focus is blurred; 0 is a pinhole.
    #[arg(long, value_name = "RADIUS", value_parser = parse_radius)]
    aperture: Option<f32>,
    /// Distance along the view, in the scene's units, that the lens has in focus [default: the
    /// scene's, or that of the camera's target].
    #[arg(long, value_name = "DISTANCE", value_parser = parse_distance)]
    focus: Option<f32>,
    /// See all around from where the camera is: a picture in longitude and latitude, best twice as
    /// wide as high (--size 2048x1024).
    #[arg(long, conflicts_with_all = ["aperture", "focus"])]
    panorama: bool,
}

impl CameraArguments {
    /// Changes the camera as was asked for.
    pub fn change(&self, camera: &mut Camera) {
        if self.panorama {
            camera.projection = Projection::Panorama;
        }
        let to_target = (camera.target - camera.origin).length();
        if let Projection::Perspective { lens, .. } = &mut camera.projection {
            if let Some(radius) = self.aperture {
                let plain = Lens { radius, focus_distance: to_target, blades: 0 };
                *lens = Some(Lens { radius, ..lens.unwrap_or(plain) });
            }
            if let (Some(lens), Some(focus_distance)) = (lens, self.focus) {
                lens.focus_distance = focus_distance;
            }
        }
    }
}

fn parse_radius(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(radius) if (0.0..=1e9).contains(&radius) => Ok(radius),
        _ => Err(format!("'{text}' is not a radius, from 0 to 1000000000")),
    }
}

fn parse_distance(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(distance) if (f32::MIN_POSITIVE..=1e9).contains(&distance) => Ok(distance),
        _ => Err(format!("'{text}' is not a distance, above 0 and at most 1000000000")),
    }
}
