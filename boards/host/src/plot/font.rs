//! The compiled-in font: widths for the layout, outlines for pixels.
use ttf_parser::{Face, GlyphId};

/// A size of one of the two faces.
pub struct Font {
    face: Face<'static>,
    scale: f32,
}

impl Font {
    /// DejaVu Sans.
    pub fn new(size: f64, bold: bool) -> Self {
        let data = if bold { dejavu::sans::bold() } else { dejavu::sans::regular() };
        let face = Face::parse(data, 0).expect("the font is compiled in");
        let scale = size as f32 / f32::from(face.units_per_em());
        Self { face, scale }
    }

    /// Units of the canvas per unit of the font.
    pub fn scale(&self) -> f32 {
        self.scale
    }

    /// Glyphs of a text with their widths; characters that the font does not have become glyph 0.
    pub fn glyphs(&self, text: &str) -> Vec<(GlyphId, f32)> {
        let glyph = |character| self.face.glyph_index(character).unwrap_or_default();
        let width = |glyph| f32::from(self.face.glyph_hor_advance(glyph).unwrap_or(0)) * self.scale;
        text.chars().map(glyph).map(|glyph| (glyph, width(glyph))).collect()
    }

    /// Width of a text.
    pub fn width(&self, text: &str) -> f64 {
        self.glyphs(text).iter().map(|(_, width)| f64::from(*width)).sum()
    }

    /// Draws a glyph's outline.
    pub fn outline(&self, glyph: GlyphId, builder: &mut dyn ttf_parser::OutlineBuilder) {
        self.face.outline_glyph(glyph, builder);
    }
}
