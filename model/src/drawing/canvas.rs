//! Boxes, arrows and texts in SVG.

use std::fmt::Write as _;

/// Width of a character of the drawings' font at size 13, in pixels, generously.
const CHARACTER: f64 = 7.4;

pub(super) const INK: &str = "#2b2d42";
pub(super) const FAINT: &str = "#b8bcc8";
pub(super) const CURRENT: &str = "#1b7f79";
pub(super) const INTERRUPTING: &str = "#c8553d";
pub(super) const NEUTRAL: &str = "#6c7283";
pub(super) const PATH: &str = "#264de4";

/// A drawing that grows to the right and down.
#[derive(Default)]
pub(super) struct Canvas {
    shapes: String,
    width: f64,
    height: f64,
}

/// How a box looks.
#[derive(Clone, Copy)]
pub(super) struct Style<'a> {
    pub(super) fill: &'a str,
    pub(super) stroke: &'a str,
    pub(super) stroke_width: f64,
    pub(super) text: &'a str,
    pub(super) radius: f64,
}

/// Where a text stands to its point.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
}

/// How wide a text of so many characters is.
pub(super) fn text_width(text: &str) -> f64 {
    let characters = text.chars().count();
    f64::from(u32::try_from(characters).unwrap_or(u32::MAX)) * CHARACTER
}

impl Canvas {
    /// A box around its centre, with one or more lines of text.
    pub(super) fn label(&mut self, centre: (f64, f64), size: (f64, f64), lines: &[&str], style: Style<'_>) {
        let ((x, y), (width, height)) = (centre, size);
        let (left, top) = (x - width / 2.0, y - height / 2.0);
        let Style { fill, stroke, stroke_width, text, radius } = style;
        let _ = writeln!(
            self.shapes,
            r#"<rect x="{left:.1}" y="{top:.1}" width="{width:.1}" height="{height:.1}" rx="{radius:.1}" fill="{fill}" stroke="{stroke}" stroke-width="{stroke_width}"/>"#
        );
        self.reach(x + width / 2.0, y + height / 2.0);
        let step = 17.0;
        let count = f64::from(u32::try_from(lines.len()).unwrap_or(1));
        let mut baseline = y + 4.5 - step * (count - 1.0) / 2.0;
        for line in lines {
            self.text((x, baseline), line, Anchor::Middle, text, 13);
            baseline += step;
        }
    }

    /// One line of text; the point is on its baseline.
    pub(super) fn text(&mut self, (x, y): (f64, f64), text: &str, anchor: Anchor, colour: &str, size: u8) {
        let (name, right) = match anchor {
            Anchor::Start => ("start", x + text_width(text) * f64::from(size) / 13.0),
            Anchor::Middle => ("middle", x),
        };
        let _ = writeln!(
            self.shapes,
            r#"<text x="{x:.1}" y="{y:.1}" text-anchor="{name}" font-size="{size}" fill="{colour}">{}</text>"#,
            escaped(text)
        );
        self.reach(right, y);
    }

    /// A straight arrow.
    pub(super) fn arrow(&mut self, from: (f64, f64), to: (f64, f64), colour: &str, width: f64) {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let length = dx.hypot(dy).max(1e-9);
        let (ux, uy) = (dx / length, dy / length);
        let head = 5.0 + 1.6 * width;
        let neck = (to.0 - ux * head, to.1 - uy * head);
        let half = head * 0.45;
        let _ = writeln!(
            self.shapes,
            r#"<line x1="{:.1}" y1="{:.1}" x2="{:.1}" y2="{:.1}" stroke="{colour}" stroke-width="{width}"/>"#,
            from.0, from.1, neck.0, neck.1
        );
        let _ = writeln!(
            self.shapes,
            r#"<polygon points="{:.1},{:.1} {:.1},{:.1} {:.1},{:.1}" fill="{colour}"/>"#,
            to.0,
            to.1,
            neck.0 - uy * half,
            neck.1 + ux * half,
            neck.0 + uy * half,
            neck.1 - ux * half
        );
    }

    fn reach(&mut self, x: f64, y: f64) {
        self.width = self.width.max(x);
        self.height = self.height.max(y);
    }

    /// The document, with a title for those who cannot see it.
    pub(super) fn document(&self, title: &str) -> String {
        let (width, height) = (self.width + 24.0, self.height + 24.0);
        format!(
            concat!(
                r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {:.0} {:.0}" width="{:.0}" height="{:.0}" "#,
                r#"font-family="Helvetica, Arial, 'Liberation Sans', sans-serif" role="img">"#,
                "\n<title>{}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n{}</svg>\n"
            ),
            width,
            height,
            width,
            height,
            escaped(title),
            self.shapes
        )
    }
}

/// Text in XML. Control characters, which XML does not allow, become a replacement
/// character.
fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            control if control.is_control() => escaped.push('\u{fffd}'),
            plain => escaped.push(plain),
        }
    }
    escaped
}
