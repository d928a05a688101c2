//! What nothing beats.

/// The numbers of those of which no other is better in one thing and no worse in the other, the quickest first. `[time, error]` of
/// each; equal ones are all there; what is not finite is never.
#[must_use]
pub fn front(points: &[[f64; 2]]) -> Vec<usize> {
    let mut order: Vec<usize> =
        (0..points.len()).filter(|&i| points[i].iter().all(|x| x.is_finite())).collect();
    let by = |axis: usize, a: usize, b: usize| points[a][axis].total_cmp(&points[b][axis]);
    order.sort_by(|&a, &b| by(0, a, b).then(by(1, a, b)).then(a.cmp(&b)));
    let mut front: Vec<usize> = Vec::new();
    for i in order {
        let is_better = front.last().is_none_or(|&last| {
            points[i][1] < points[last][1] || points[i].map(f64::to_bits) == points[last].map(f64::to_bits)
        });
        if is_better {
            front.push(i);
        }
    }
    front
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_of_a_list_is_what_a_hand_finds() {
        let points = [
            [4.0, 1.0],
            [1.0, 8.0],
            [2.0, 3.0],
            [2.0, 5.0], // beaten by the one above: as quick, worse
            [3.0, 3.0], // beaten: slower, no better
            [5.0, 2.0], // beaten by the first
            [2.0, 3.0], // the same as the third
            [f64::NAN, 0.0],
            [9.0, 0.5],
        ];
        assert_eq!(front(&points), [1, 2, 6, 0, 8], "front");
        assert_eq!(front(&[]), [0; 0], "of none");
        assert_eq!(front(&[[1.0, 1.0]]), [0], "of one");
    }
}
