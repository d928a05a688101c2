//! Pictures of skies, and the tables that they are drawn from.

use crate::{Part, Table, agree, viewer};
use specula::image::Image;
use specula::light::{Arriving, EnvironmentMap};
use specula::math::lanes::{IntLanes, Lanes};
use specula::math::{Rgb, Vec3};
use specula::sampling::{Table1d, Table2d};

#[test]
fn skies_are_the_same_at_every_width() {
    let pixel = |i: u16| Rgb::new(f32::from(i % 7), f32::from(i % 11), f32::from(i % 5));
    let mut image = Image::from_pixels(24, 12, (0..288).map(pixel).collect()).expect("fits");
    image.set_pixel(0, 3, Rgb::gray(1e3));
    agree(&Skies { map: EnvironmentMap::new(image, 0.5, 0.3).expect("shines") });
}

/// What comes from above and below.
struct Skies {
    map: EnvironmentMap,
}

impl Part for Skies {
    #[inline(always)]
    fn shade<F: Lanes>(&self, table: &mut Table, input: [F; 8]) {
        let [.., y] = input;
        let d = viewer(input);
        // 1e-7 in a coordinate of 24 pixels is 3e-6 of a pixel, and beside the sun its light changes by 1e3 over one.
        for (who, d) in [("above", d), ("below", -d), ("aside", Vec3::new(d.z, d.x, d.y.copysign(y)))] {
            let Arriving { radiance, pdf } = self.map.arriving(d);
            table.put([who, "radiance"], [1e-4, 100.0], radiance.g);
            // At the poles the sine is as small as the direction's rounding.
            table.put([who, "density"], [1e-3, 1.0], pdf);
        }
    }
}

#[test]
fn tables_are_the_same_at_every_width() {
    let weight = |i: u16| if i.is_multiple_of(3) { 0.0 } else { f32::from(i % 17) };
    let mut weights: Vec<f32> = (0..1000).map(weight).collect();
    weights[321] = 1e6;
    let one = Table1d::new(&weights).expect("positive");
    let two = Table2d::new(&weights, 40).expect("positive");
    agree(&Tables { one, two });
}

/// Entries of tables: whole numbers, so the same exactly.
struct Tables {
    one: Table1d,
    two: Table2d,
}

impl Part for Tables {
    #[inline(always)]
    fn shade<F: Lanes>(&self, table: &mut Table, input: [F; 8]) {
        let [_, _, u, v, ..] = input;
        let picks = self.one.sample_lanes(u);
        table.put(["line", "entry"], [0.0, 0.0], picks.index.signed_to_float());
        table.put(["line", "probability"], [0.0, 0.0], picks.probability);
        table.put(["line", "place"], [1e-6, 1.0], picks.within);
        let picks = self.two.sample([u, v]);
        table.put(["square", "column"], [0.0, 0.0], picks.column.signed_to_float());
        table.put(["square", "row"], [0.0, 0.0], picks.row.signed_to_float());
        table.put(["square", "probability"], [0.0, 0.0], picks.probability);
        table.put(["square", "place"], [1e-6, 1.0], picks.within[0] * picks.within[1]);
    }
}
