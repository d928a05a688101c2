//! Words for messages.

/// Letters of the longest word that may be misspelt: comparing takes time and memory by the product of lengths.
const LONGEST: usize = 256;

/// The candidate nearest to a misspelt word, if any is near: at most a third of the letters are wrong, or one is the
/// beginning of the other.
pub(crate) fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let word = word.to_lowercase();
    let length = word.chars().count();
    let allowed = (length / 3).max(1);
    if length > LONGEST {
        return None;
    }
    let distance = |candidate: &str| {
        // Letters of a character may be more in lower case, but no fewer than a third.
        if candidate.len() > 12 * LONGEST {
            return usize::MAX;
        }
        let candidate = candidate.to_lowercase();
        let begins = length >= 3 && (candidate.starts_with(&word) || word.starts_with(&candidate));
        let distance = strsim::damerau_levenshtein(&word, &candidate);
        if begins { distance.min(allowed) } else { distance }
    };
    candidates
        .into_iter()
        .map(|candidate| (distance(candidate), candidate))
        .filter(|&(distance, candidate)| distance <= allowed && distance < candidate.chars().count())
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, candidate)| candidate)
}

/// `` `a`, `b` or `c` ``; the conjunction is put before the last.
pub(crate) fn list<'a>(words: impl IntoIterator<Item = &'a str>, conjunction: &str) -> String {
    let quoted: Vec<String> = words.into_iter().map(|word| format!("`{word}`")).collect();
    join(&quoted, conjunction)
}

/// `a, b or c`; the conjunction is put before the last.
pub(crate) fn join(words: &[String], conjunction: &str) -> String {
    match words {
        [] => String::new(),
        [only] => only.clone(),
        [first @ .., last] => format!("{} {conjunction} {last}", first.join(", ")),
    }
}

/// A remedy for a word that is none of the candidates: the nearest one, else all of them as what it must be.
pub(crate) fn suggest(word: &str, candidates: &[&str]) -> String {
    match nearest(word, candidates.iter().copied()) {
        Some(meant) => format!("did you mean `{meant}`?"),
        None => format!("it must be {}", list(candidates.iter().copied(), "or")),
    }
}

/// A remedy for a name that is none of those there are: the nearest one, else the first few of them.
pub(crate) fn suggest_name(name: &str, known: &[&str], what: &str) -> String {
    const SHOWN: usize = 12;
    if known.is_empty() {
        return format!("there is no {what}; define it first");
    }
    let (shown, rest) = known.split_at(known.len().min(SHOWN));
    match nearest(name, known.iter().copied()) {
        Some(meant) => format!("did you mean `{meant}`?"),
        None if rest.is_empty() => format!("known are {}", list(shown.iter().copied(), "and")),
        None => format!("known are {}, and {} more", list(shown.iter().copied(), "and"), rest.len()),
    }
}

/// Small numbers in words.
pub(crate) fn count(n: usize) -> String {
    let words = ["no", "one", "two", "three", "four"];
    words.get(n).map_or_else(|| n.to_string(), |&word| word.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_near_words_are_suggested() {
        let known = ["diffuse", "mirror", "conductor"];
        assert_eq!(nearest("difuse", known), Some("diffuse"), "a letter left out");
        assert_eq!(nearest("Mirror", known), Some("mirror"), "another case");
        assert_eq!(nearest("condcutor", known), Some("conductor"), "letters swapped");
        assert_eq!(nearest("vfov", ["up", "vfov_deg"]), Some("vfov_deg"), "the unit left out");
        assert_eq!(nearest("glass", known), None, "another word");
        assert_eq!(nearest("x", ["y", "k"]), None, "nothing in common");
        assert_eq!(nearest("", known), None, "no word");
        // Compared letter by letter these would take terabytes.
        let [long, longer] = ["a".repeat(1 << 20), "b".repeat(1 << 20)];
        assert_eq!(nearest(&long, [longer.as_str()]), None, "endless words");
        assert_eq!(nearest("mirror", [longer.as_str(), "miror"]), Some("miror"), "an endless candidate");
    }

    #[test]
    fn lists_read_like_sentences() {
        assert_eq!(list(["a"], "or"), "`a`", "one");
        assert_eq!(list(["a", "b", "c"], "or"), "`a`, `b` or `c`", "three");
    }
}
