//! Dashed lines: plotters draws solid ones only.

use super::style::Dash;

/// Cuts a path into the pieces that a dash pattern leaves of it.
pub fn dashes(points: &[(f64, f64)], dash: Dash) -> Vec<Vec<(f64, f64)>> {
    if dash.is_empty() || dash.iter().any(|d| *d <= 0.0) {
        return if points.len() > 1 { vec![points.to_vec()] } else { Vec::new() };
    }
    let mut pieces = Vec::new();
    let mut piece: Vec<(f64, f64)> = points.first().copied().into_iter().collect();
    let (mut index, mut left) = (0usize, dash[0]);
    for w in points.windows(2) {
        let (mut a, b) = (w[0], w[1]);
        loop {
            let length = (b.0 - a.0).hypot(b.1 - a.1);
            let drawn = index % 2 == 0;
            if length <= left {
                left -= length;
                if drawn {
                    piece.push(b);
                }
                break;
            }
            let share = left / length;
            let cut = (a.0 + share * (b.0 - a.0), a.1 + share * (b.1 - a.1));
            if drawn {
                piece.push(cut);
                pieces.push(std::mem::take(&mut piece));
            } else {
                piece = vec![cut];
            }
            index += 1;
            left = dash[index % dash.len()];
            a = cut;
        }
    }
    if piece.len() > 1 && index % 2 == 0 {
        pieces.push(piece);
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::style;

    #[test]
    fn dashes_follow_the_path_round_its_corners() {
        let path = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0)];
        let got = dashes(&path, &[6.0, 6.0]);
        let expected = vec![vec![(0.0, 0.0), (6.0, 0.0)], vec![(10.0, 2.0), (10.0, 8.0)]];
        assert_eq!(got, expected, "6 on, 6 off along 20 (got left, expected right)");
        assert_eq!(dashes(&path, style::SOLID), vec![path.to_vec()], "solid is one piece");
        assert!(dashes(&[(1.0, 1.0)], style::SOLID).is_empty(), "a point is no line");
        assert!(dashes(&[], &[6.0, 6.0]).is_empty());
    }
}
