//! Colours and sizes.

use eframe::egui::{Color32, Context, FontId, TextStyle, ThemePreference, Visuals};

/// Behind the picture: dark and without a hue, so that the picture's colours are seen.
pub const BACKGROUND: Color32 = Color32::from_gray(24);
/// The renders beside each other, in the curves and wherever they are named.
pub const SIDES: [Color32; 2] = [Color32::from_rgb(255, 166, 77), Color32::from_rgb(102, 178, 255)];
/// Lines from a path to lights that are seen.
pub const LIGHT: Color32 = Color32::from_rgb(255, 221, 89);
/// Lines from a path to lights that something hides.
pub const SHADOW: Color32 = Color32::from_gray(160);
/// What has gone wrong.
pub const WRONG: Color32 = Color32::from_rgb(255, 110, 100);
/// What has gone well.
pub const GOOD: Color32 = Color32::from_rgb(130, 205, 130);
/// Behind text that lies on the picture.
pub const VEIL: Color32 = Color32::from_black_alpha(190);

/// Dark, with somewhat smaller text than egui's own.
pub fn apply(ctx: &Context) {
    ctx.set_theme(ThemePreference::Dark);
    let mut visuals = Visuals::dark();
    visuals.panel_fill = Color32::from_gray(32);
    visuals.selection.bg_fill = Color32::from_rgb(120, 78, 30);
    visuals.override_text_color = Some(Color32::from_gray(220));
    ctx.set_visuals(visuals);
    ctx.all_styles_mut(|style| {
        style.spacing.item_spacing = [8.0, 6.0].into();
        style.spacing.slider_width = 130.0;
        style.text_styles.insert(TextStyle::Body, FontId::proportional(13.0));
        style.text_styles.insert(TextStyle::Button, FontId::proportional(13.0));
        style.text_styles.insert(TextStyle::Heading, FontId::proportional(15.0));
        style.text_styles.insert(TextStyle::Small, FontId::proportional(11.0));
        style.text_styles.insert(TextStyle::Monospace, FontId::monospace(12.0));
    });
}
