//! A picture as PNG.

use std::sync::Arc;

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::fontdb::Database;
use resvg::usvg::{Options, Tree};

use crate::error::{Error, Result};

/// How many pixels a unit of the picture takes: 640 units are 1280 pixels.
const SCALE: f32 = 2.0;

/// The most pixels of a picture along either side.
const MOST: u32 = 20_000;

/// The family of the letters, which come with the program: a picture is the
/// same on a machine without any.
const FAMILY: &str = "Noto Sans";

/// An SVG document as PNG, two pixels for each of its units.
///
/// ```
/// use couloir::export::png;
/// use couloir::report::{CalibrationReport, pictures};
/// let mut report = CalibrationReport::default();
/// (report.times, report.values) = (vec![0.0, 1.0], vec![0.0, 4.2]);
/// let bytes = png(&pictures(&report)[0].svg)?;
/// assert!(bytes.starts_with(b"\x89PNG"));
/// # Ok::<(), couloir::Error>(())
/// ```
///
/// # Errors
/// What is not SVG, or has no size or a very large one.
pub fn png(svg: &str) -> Result<Vec<u8>> {
    let tree = Tree::from_str(svg, &options())
        .map_err(|error| Error::system(format!("the picture: {error}")))?;
    let size = tree.size().to_int_size().scale_by(SCALE);
    let size = size.filter(|s| s.width().max(s.height()) <= MOST);
    let map = size.and_then(|size| Pixmap::new(size.width(), size.height()));
    let mut map = map.ok_or_else(|| {
        Error::system(format!(
            "the picture: more than {MOST} pixels wide or high, or none"
        ))
    })?;
    let scale = Transform::from_scale(SCALE, SCALE);
    resvg::render(&tree, scale, &mut map.as_mut());
    map.encode_png()
        .map_err(|error| Error::system(format!("the picture: {error}")))
}

fn options() -> Options<'static> {
    let mut fonts = Database::new();
    for font in [notosans::REGULAR_TTF, notosans::BOLD_TTF] {
        fonts.load_font_data(font.to_vec());
    }
    fonts.set_sans_serif_family(FAMILY);
    Options {
        font_family: FAMILY.to_owned(),
        fontdb: Arc::new(fonts),
        ..Options::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_are_drawn() {
        let of = |text: &str| {
            png(&format!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" \
                 viewBox=\"0 0 60 20\" font-family=\"system-ui, sans-serif\">\
                 <text x=\"2\" y=\"15\">{text}</text></svg>"
            ))
            .unwrap()
        };
        let [none, one] = ["", "m\u{b2}/s"].map(of);
        let inked = |png: &[u8]| {
            let map = Pixmap::decode_png(png).unwrap();
            assert_eq!((map.width(), map.height()), (120, 40));
            map.pixels().iter().filter(|p| p.alpha() > 0).count()
        };
        assert_eq!(inked(&none), 0);
        assert!(inked(&one) > 100);
    }

    #[test]
    fn what_is_no_picture_is_refused() {
        for bad in [
            "",
            "<html/>",
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"0\"/>",
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"1e9\" \
             height=\"5\"/>",
        ] {
            let error = png(bad).unwrap_err().to_string();
            assert!(error.starts_with("the picture: "), "{error}");
        }
    }
}
