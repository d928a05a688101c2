//! Whether parts make up a picture: every sample of every pixel once.

use crate::image::Window;
use crate::render::Outline;
use std::collections::BTreeMap;
use std::ops::Range;

/// What keeps parts from being a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Gap {
    /// Samples that no part has.
    Missing {
        /// Which.
        samples: Range<u32>,
        /// Of which pixels; the smallest rectangle around them.
        window: Window,
    },
    /// Samples that two parts have.
    Doubled {
        /// Which.
        samples: Range<u32>,
        /// Of which pixels; the smallest rectangle around them.
        window: Window,
        /// The parts, by their places in the list.
        parts: [usize; 2],
    },
}

/// The pixels that parts are to make up where nobody says: those of each, if all have the same, else the whole picture.
///
/// # Panics
/// Without parts.
#[must_use]
pub fn wanted(parts: &[&Outline]) -> Window {
    let Outline { window, full: [width, height], .. } = *parts[0];
    if parts.iter().all(|part| part.window == window) { window } else { Window::whole(width, height) }
}

/// The order in which parts are added, whatever that of the list: from top to bottom, then by samples. Equal ones double each other.
#[must_use]
pub fn order(parts: &[&Outline]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..parts.len()).collect();
    order.sort_by_key(|&part| {
        let Outline { window: Window { x0, y0, x1, y1 }, samples, .. } = parts[part];
        (*y0, *x0, *y1, *x1, samples.start, samples.end)
    });
    order
}

/// All samples of the pixels of a window that are missing or doubled, of parts of one picture.
#[must_use]
pub fn gaps(parts: &[&Outline], window: Window) -> Vec<Gap> {
    // Edges of parts cut the window into cells in which all pixels are alike.
    let cuts = |edges: &mut dyn Iterator<Item = u32>, from: u32, to: u32| {
        let mut cuts: Vec<u32> = edges.filter(|x| (from..=to).contains(x)).chain([from, to]).collect();
        cuts.sort_unstable();
        cuts.dedup();
        cuts
    };
    let columns =
        cuts(&mut parts.iter().flat_map(|part| [part.window.x0, part.window.x1]), window.x0, window.x1);
    let rows =
        cuts(&mut parts.iter().flat_map(|part| [part.window.y0, part.window.y1]), window.y0, window.y1);
    let order = order(parts);
    let spp = parts.iter().map(|part| part.spp).max().unwrap_or(0);
    let mut found = Found::default();
    for row in rows.windows(2) {
        let of_row: Vec<usize> = order
            .iter()
            .copied()
            .filter(|&part| (parts[part].window.y0..parts[part].window.y1).contains(&row[0]))
            .collect();
        for column in columns.windows(2) {
            let cell = Window { x0: column[0], y0: row[0], x1: column[1], y1: row[1] };
            let mut there: Vec<usize> = of_row
                .iter()
                .copied()
                .filter(|&part| parts[part].window.contains(cell.x0, cell.y0))
                .collect();
            there.sort_by_key(|&part| (parts[part].samples.start, parts[part].samples.end, part));
            let (mut end, mut last) = (0, None);
            for part in there {
                let samples = &parts[part].samples;
                match last {
                    Some(last) if samples.start < end => {
                        let both = samples.start..end.min(samples.end);
                        found.add((both.start, both.end, Some([last, part])), cell);
                    }
                    _ if samples.start > end => found.add((end, samples.start, None), cell),
                    _ => {}
                }
                if samples.end > end {
                    (end, last) = (samples.end, Some(part));
                }
            }
            if end < spp {
                found.add((end, spp, None), cell);
            }
        }
    }
    found.gaps()
}

/// Gaps by samples and parts, with the rectangles around their pixels.
#[derive(Default)]
struct Found(BTreeMap<(u32, u32, Option<[usize; 2]>), Window>);

impl Found {
    fn add(&mut self, key: (u32, u32, Option<[usize; 2]>), cell: Window) {
        let around = self.0.entry(key).or_insert(cell);
        *around = Window {
            x0: around.x0.min(cell.x0),
            y0: around.y0.min(cell.y0),
            x1: around.x1.max(cell.x1),
            y1: around.y1.max(cell.y1),
        };
    }

    fn gaps(self) -> Vec<Gap> {
        let gap = |((start, end, parts), window): ((u32, u32, Option<[usize; 2]>), Window)| {
            let samples = start..end;
            match parts {
                Some(parts) => Gap::Doubled { samples, window, parts },
                None => Gap::Missing { samples, window },
            }
        };
        self.0.into_iter().map(gap).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Layout;

    fn part(window: [u32; 4], samples: Range<u32>) -> Outline {
        let [x0, y0, x1, y1] = window;
        Outline {
            full: [40, 30],
            window: Window { x0, y0, x1, y1 },
            layout: Layout::default(),
            samples,
            spp: 64,
            has_limit: false,
        }
    }

    fn found(parts: &[Outline]) -> Vec<Gap> {
        let parts: Vec<&Outline> = parts.iter().collect();
        gaps(&parts, wanted(&parts))
    }

    const WHOLE: [u32; 4] = [0, 0, 40, 30];

    #[test]
    fn slices_and_crops_make_up_a_picture() {
        assert_eq!(found(&[part(WHOLE, 32..64), part(WHOLE, 0..32)]), [], "slices in any order");
        let crop = [3, 4, 9, 11];
        assert_eq!(found(&[part(crop, 0..64)]), [], "a crop alone is a picture");
        let tiles = [[0, 0, 20, 30], [20, 0, 40, 10], [20, 10, 40, 30]];
        let mut parts = tiles.map(|tile| part(tile, 0..64)).to_vec();
        assert_eq!(found(&parts), [], "crops");
        parts[1].samples = 0..10;
        parts.push(part([20, 0, 40, 10], 10..64));
        assert_eq!(found(&parts), [], "a crop in slices");
    }

    #[test]
    fn what_is_missing_or_doubled_is_told_once() {
        let window = |[x0, y0, x1, y1]: [u32; 4]| Window { x0, y0, x1, y1 };
        let parts = [part(WHOLE, 48..64), part(WHOLE, 0..16), part(WHOLE, 8..32)];
        let doubled = Gap::Doubled { samples: 8..16, window: window(WHOLE), parts: [1, 2] };
        let missing = Gap::Missing { samples: 32..48, window: window(WHOLE) };
        assert_eq!(found(&parts), [doubled, missing], "slices");
        // The last row of crops was forgotten.
        let parts = [part([0, 0, 20, 20], 0..64), part([20, 0, 40, 20], 0..64)];
        let rest = Gap::Missing { samples: 0..64, window: window([0, 20, 40, 30]) };
        assert_eq!(found(&parts), [rest], "crops");
        let parts = [part([0, 0, 25, 30], 0..64), part([20, 0, 40, 30], 0..64)];
        let both = Gap::Doubled { samples: 0..64, window: window([20, 0, 25, 30]), parts: [0, 1] };
        assert_eq!(found(&parts), [both], "crops that overlap");
    }
}
