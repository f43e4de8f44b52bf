//! Lists in the order in which things first come: each thing once, and things together by a key.

/// Each of several things once.
pub(crate) fn each_once<T: PartialEq>(all: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut once: Vec<T> = Vec::new();
    for one in all {
        if !once.contains(&one) {
            once.push(one);
        }
    }
    once
}

/// Each key with all that has it.
pub(crate) fn grouped<K: PartialEq, T>(all: impl IntoIterator<Item = (K, T)>) -> Vec<(K, Vec<T>)> {
    let mut groups: Vec<(K, Vec<T>)> = Vec::new();
    for (key, one) in all {
        match groups.iter_mut().find(|(known, _)| *known == key) {
            Some((_, group)) => group.push(one),
            None => groups.push((key, vec![one])),
        }
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_came_first_stays_first() {
        assert_eq!(each_once([3, 1, 3, 2, 1]), [3, 1, 2], "law: each once, not sorted");
        let expected = [("b", vec![1, 3]), ("a", vec![2])];
        assert_eq!(grouped([("b", 1), ("a", 2), ("b", 3)]), expected, "law: in their order");
    }
}
