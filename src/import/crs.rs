//! From longitudes and latitudes to metres on a projection.

use proj4rs::Proj;
use proj4rs::transform::transform;

use crate::error::{Error, Result};
use crate::io::quoted;

/// A place on a projection: x (east) and y (north) \[m\].
pub(super) type Place = (f64, f64);

/// The Austrian datum, by its transformation for the whole country, good to
/// a metre or two.
const MGI: &str = "+ellps=bessel +towgs84=577.326,90.129,463.919,5.137,1.474,\
                   5.297,2.4232";

const SWISS: &str = "+lat_0=46.9524055555556 +lon_0=7.43958333333333 +k_0=1 \
                     +ellps=bessel +towgs84=674.374,15.056,405.346,0,0,0,0";

const ETRS: &str = "+ellps=GRS80 +towgs84=0,0,0,0,0,0,0";

/// Projections by their EPSG codes, with their datum. The Austrian meridian
/// strips and the zones of UTM are worked out.
const KNOWN: [(u32, &str, &str); 4] = [
    (2056, "+proj=somerc +x_0=2600000 +y_0=1200000", SWISS),
    (
        2154,
        "+proj=lcc +lat_1=49 +lat_2=44 +lat_0=46.5 +lon_0=3 +x_0=700000 \
         +y_0=6600000",
        ETRS,
    ),
    (21781, "+proj=somerc +x_0=600000 +y_0=200000", SWISS),
    (
        31287,
        "+proj=lcc +lat_1=49 +lat_2=46 +lat_0=47.5 +lon_0=13.3333333333333 \
         +x_0=400000 +y_0=400000",
        MGI,
    ),
];

/// A projection of longitudes and latitudes of WGS 84.
#[derive(Clone)]
pub(super) struct Crs {
    globe: Proj,
    plane: Proj,
    /// What it is called in messages.
    pub(super) name: String,
}

impl Crs {
    /// By an EPSG code that is known, or a PROJ string.
    pub(super) fn parse(text: &str) -> Result<Self> {
        let text = text.trim();
        if text.starts_with('+') {
            return Self::of(text, format!("the projection {}", quoted(text)));
        }
        let digits = text
            .strip_prefix("EPSG:")
            .or_else(|| text.strip_prefix("epsg:"))
            .unwrap_or(text);
        let code = digits.parse::<u32>().ok();
        match code.map_or(Ok(None), Self::by_code)? {
            Some(crs) => Ok(crs),
            None => Err(Error::input(format!(
                "--crs: found {}; expected one of {}, or a PROJ string such \
                 as \"+proj=utm +zone=32 +datum=WGS84\"",
                quoted(text),
                known_codes()
            ))),
        }
    }

    /// By an EPSG code; nothing where that is not known.
    pub(super) fn by_code(code: u32) -> Result<Option<Self>> {
        let plane = definition(code);
        let named = |plane: String| Self::of(&plane, format!("EPSG:{code}"));
        plane.map(named).transpose()
    }

    /// A transverse Mercator projection about a place \[degrees\].
    pub(super) fn local(longitude: f64, latitude: f64) -> Result<Self> {
        let plane = format!(
            "+proj=tmerc +lat_0={latitude:.7} +lon_0={longitude:.7} +k=1 \
             +x_0=0 +y_0=0 +ellps=WGS84 +towgs84=0,0,0,0,0,0,0"
        );
        let name = "a transverse Mercator projection about the log's middle";
        Self::of(&plane, name.to_owned())
    }

    fn of(plane: &str, name: String) -> Result<Self> {
        // proj4rs takes numbers apart byte by byte.
        if !plane.is_ascii() {
            return Err(Error::input(format!(
                "--crs: {} has letters that no PROJ string has; expected \
                 plain ones: type it again",
                quoted(plane)
            )));
        }
        let parsed = Proj::from_proj_string(plane).map_err(|error| {
            Error::input(format!(
                "--crs: {} cannot be used ({error}); expected a PROJ string \
                 of a projection in metres",
                quoted(plane)
            ))
        })?;
        if parsed.is_latlong() || parsed.is_geocent() {
            return Err(Error::input(format!(
                "--crs: {} has degrees; expected a projection in metres, as \
                 a terrain model has: that of the terrain model",
                quoted(plane)
            )));
        }
        let globe = "+proj=longlat +ellps=WGS84 +towgs84=0,0,0,0,0,0,0";
        let globe = Proj::from_proj_string(globe).map_err(|error| {
            Error::system(format!("WGS 84 is not to be had: {error}"))
        })?;
        Ok(Self { globe, plane: parsed, name })
    }

    /// Where a longitude and a latitude \[degrees\] lie, at a height \[m\].
    pub(super) fn project(
        &self,
        (longitude, latitude): (f64, f64),
        height: f64,
    ) -> Option<Place> {
        let (x, y) = (longitude.to_radians(), latitude.to_radians());
        let mut point = (x, y, height);
        transform(&self.globe, &self.plane, &mut point).ok()?;
        let (x, y, _) = point;
        (x.abs() < 1e9 && y.abs() < 1e9).then_some((x, y))
    }
}

/// The EPSG codes that are known, in words.
pub(super) fn known_codes() -> String {
    format!(
        "EPSG:{}, 25828 to 25838, 31254 to 31259, 32601 to 32660 and 32701 \
         to 32760",
        KNOWN.map(|known| known.0.to_string()).join(", ")
    )
}

/// What an EPSG code stands for, where that is known.
fn definition(code: u32) -> Option<String> {
    let utm = |zone: u32, more: &str| format!("+proj=utm +zone={zone} {more}");
    let wgs = "+ellps=WGS84 +towgs84=0,0,0,0,0,0,0";
    match code {
        25828..=25838 => Some(utm(code - 25800, ETRS)),
        31254..=31259 => Some(meridian_strip(code)),
        32601..=32660 => Some(utm(code - 32600, wgs)),
        32701..=32760 => Some(utm(code - 32700, &format!("+south {wgs}"))),
        _ => {
            let mut found = KNOWN.iter().filter(|known| known.0 == code);
            found.next().map(|(_, plane, datum)| format!("{plane} {datum}"))
        }
    }
}

/// An Austrian meridian strip: about 10, 13 or 16 degrees and 20 minutes east
/// of Greenwich, first as Gauss and Krueger have it (31254 to 31256), then with
/// eastings that tell the strips apart (31257 to 31259).
fn meridian_strip(code: u32) -> String {
    let strip = (code - 31254) % 3;
    let degrees = f64::from(10 + 3 * strip) + 1.0 / 3.0;
    let easting = if code < 31257 { 0 } else { 150_000 + 300_000 * strip };
    format!(
        "+proj=tmerc +lat_0=0 +lon_0={degrees:.13} +k=1 +x_0={easting} \
         +y_0=-5000000 {MGI}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: Option<Place>, b: Place, error: f64) {
        let (x, y) = a.unwrap();
        assert!((x - b.0).hypot(y - b.1) < error, "{x} {y}: {b:?}");
    }

    #[test]
    fn known_places_lie_where_they_are_known_to_lie() {
        // The old observatory of Bern is the middle of the Swiss grid; its
        // place in WGS 84 is published by the Federal Office of Topography.
        let bern = (7.438_632_49, 46.951_082_88);
        let lv95 = Crs::parse("EPSG:2056").unwrap();
        near(lv95.project(bern, 0.0), (2_600_000.0, 1_200_000.0), 1.0);
        // On the central meridian: 500 km east, and the length of the arc of
        // the meridian to 45 degrees, 4984944.378 m, times 0.9996.
        let utm = Crs::parse("EPSG:32632").unwrap();
        near(utm.project((9.0, 45.0), 0.0), (5e5, 4_982_950.400), 0.01);
        let etrs = Crs::parse("25832").unwrap();
        near(etrs.project((9.0, 45.0), 0.0), (5e5, 4_982_950.400), 0.01);
    }

    #[test]
    fn every_known_projection_can_be_used() {
        for code in KNOWN.map(|known| known.0).into_iter().chain(31254..=31259)
        {
            let crs = Crs::parse(&format!("EPSG:{code}")).unwrap();
            assert!(crs.project((10.0, 47.0), 1000.0).is_some(), "{code}");
        }
        // The strips' eastings, by the surveyor's office.
        let east = [150_000.0, 450_000.0, 750_000.0];
        for (code, east) in (31254..).zip(east) {
            let of = |code: u32| Crs::parse(&code.to_string()).unwrap();
            let at = |code| of(code).project((12.0, 47.0), 0.0).unwrap();
            let (plain, told) = (at(code), at(code + 3));
            near(Some(told), (plain.0 + east, plain.1), 1e-6);
        }
        // The middle strip's own meridian; MGI lies within 200 m of WGS 84.
        let strip = Crs::parse("31255").unwrap();
        let (x, _) = strip.project((13.0 + 1.0 / 3.0, 47.0), 0.0).unwrap();
        assert!(x.abs() < 200.0, "{x}");
        let local = Crs::local(11.38, 47.31).unwrap();
        near(local.project((11.38, 47.31), 0.0), (0.0, 0.0), 1e-3);
        near(local.project((11.38, 47.32), 0.0), (0.0, 1111.86), 0.5);
    }

    #[test]
    fn what_is_no_projection_is_refused() {
        for text in [
            "",
            "EPSG:4326",
            "31253",
            "+proj=nothing",
            "+proj=longlat",
            "+proj=utm +zone=99",
            "+",
            "+proj=tmerc +lat_0=x",
            "+proj=lcc +lat_1=\u{feff}44",
        ] {
            let error = Crs::parse(text).map(|crs| crs.name).unwrap_err();
            assert!(error.to_string().starts_with("--crs: "), "{error}");
        }
    }
}
