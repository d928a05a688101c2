//! How much time leaving a capability out saves: from the table that `benches/specialise.rs` records.

use std::collections::HashMap;

/// The table: scenes, each with everything that it does not need switched on alone and together, and the speed relative to that of
/// the scene as it is.
const TABLE: &str = include_str!("../../../benches/record/specialise.csv");

/// Time that leaving a capability out saves in scenes that do not need it, as was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Processor time with it over that without: the median over scenes.
    pub ratio: f64,
    /// The least and the greatest of these.
    pub range: [f64; 2],
    /// In how many scenes.
    pub scenes: usize,
}

/// What was measured of each contestant, capabilities among them by their words.
#[must_use]
pub fn all() -> HashMap<&'static str, Measured> {
    of_table(TABLE)
}

/// What a table says of each contestant.
fn of_table(table: &str) -> HashMap<&str, Measured> {
    let mut rows = table.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(','));
    let head: Vec<&str> = rows.next().map(Iterator::collect).unwrap_or_default();
    let column = |name: &str| head.iter().position(|column| *column == name);
    let (Some(contestant), Some(ratio)) = (column("contestant"), column("ratio")) else {
        return HashMap::new();
    };
    let mut ratios: HashMap<&str, Vec<f64>> = HashMap::new();
    for row in rows {
        let row: Vec<&str> = row.collect();
        // The table has speeds.
        let speed: Option<f64> = row.get(ratio).and_then(|speed| speed.parse().ok());
        if let (Some(name), Some(speed)) = (row.get(contestant).copied(), speed.filter(|speed| *speed > 0.0))
        {
            ratios.entry(name).or_default().push(speed.recip());
        }
    }
    ratios.into_iter().filter_map(|(name, ratios)| Some((name, summary(ratios)?))).collect()
}

/// The middle and both ends.
fn summary(mut ratios: Vec<f64>) -> Option<Measured> {
    ratios.sort_by(f64::total_cmp);
    let (first, last) = (*ratios.first()?, *ratios.last()?);
    let middle = (ratios.len() - 1) / 2;
    let median = f64::midpoint(ratios[middle], ratios[ratios.len() / 2]);
    Some(Measured { ratio: median, range: [first, last], scenes: ratios.len() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::needs::capability::Capability;

    #[test]
    fn tables_are_read_by_their_columns() {
        let table = "# machine\nrace,contestant,unit,items_per_cpu_s,ratio,ratio_spread\n\
            a,as it is,samples,100,1.0,0.0\na,lens,samples,50,0.5,0.1\nb,lens,samples,80,0.8,0.1\n";
        let measured = of_table(table);
        let lens = measured.get("lens").expect("measured twice");
        assert_eq!((lens.scenes, lens.range), (2, [1.25, 2.0]), "{lens:?}");
        assert!((lens.ratio - 1.625).abs() < 1e-12, "the middle of both: {lens:?}");
        assert_eq!(measured.get("media"), None, "not measured");
    }

    #[test]
    fn the_table_knows_capabilities_only() {
        let known = Capability::ALL.map(Capability::word);
        for line in TABLE.lines().filter(|line| !line.starts_with('#')).skip(1) {
            let name = line.split(',').nth(1).unwrap_or_default();
            let is_known = known.contains(&name) || ["as it is", "everything"].contains(&name);
            assert!(is_known, "{line}");
        }
    }
}
