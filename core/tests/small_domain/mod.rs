//! Every case of a small domain, the smallest first.
#![allow(dead_code, reason = "each test file takes the part it needs")]

use crate::situation::{Person, Situation};

/// How large a case is: first its number of conditions, then the sum of its ranks.
pub(crate) fn size(situation: &Situation) -> (usize, u32) {
    let people = [&situation.current, &situation.interrupting];
    (
        people.iter().map(|person| person.status.len()).sum(),
        people.iter().flat_map(|person| &person.ranks).copied().map(u32::from).sum(),
    )
}

/// All cases with `conditions` conditions in total, no two users sharing one, in which
/// every condition activates any subset of two dispositions, both goals imply both, and
/// ranks go up to 2.
pub(crate) fn cases(conditions: usize) -> impl Iterator<Item = Situation> {
    const SUBSETS: [&[u16]; 4] = [&[], &[0], &[1], &[0, 1]];
    let all_rows = (0..conditions).fold(vec![vec![]], |shorter: Vec<Vec<Vec<u16>>>, _| {
        let longer = shorter
            .into_iter()
            .flat_map(|rows| SUBSETS.map(|subset| [rows.clone(), vec![subset.to_vec()]].concat()));
        longer.collect()
    });
    all_rows.into_iter().flat_map(move |rows| {
        (0..=conditions).flat_map(move |interrupters| {
            let rows = rows.clone();
            (0..81u8).map(move |ranks| {
                let [r0, r1, r2, r3] = [ranks / 27, ranks / 9 % 3, ranks / 3 % 3, ranks % 3];
                let person = |ranks: [u8; 2], status: std::ops::Range<usize>| Person {
                    ranks: ranks.to_vec(),
                    status: (0..=u16::MAX).take(status.end).skip(status.start).collect(),
                    mentions: vec![1, 1],
                };
                Situation {
                    rows: rows.clone(),
                    interrupting: person([r0, r1], 0..interrupters),
                    current: person([r2, r3], interrupters..conditions),
                }
            })
        })
    })
}

/// The size of the smallest cases of up to `most` conditions of which `holds` is true.
pub(crate) fn smallest(most: usize, mut holds: impl FnMut(&Situation) -> bool) -> Option<(usize, u32)> {
    (0..=most)
        .find_map(|conditions| cases(conditions).filter(|case| holds(case)).map(|case| size(&case)).min())
}
