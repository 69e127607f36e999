//! What is written into a table is what is read from it, whatever the rows and however many.

#![expect(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing, reason = "it is a test")]

use std::fs::File;
use std::io::Write as _;

use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use parquet::schema::parser::parse_message_type;
use proptest::prelude::*;
use selfneg::fleet::{Cell, ROWS_IN_GROUP, Row, Table, TableError, Tables, schema};

/// A row of all kinds of columns.
#[derive(Clone, Debug, PartialEq)]
struct Sample {
    text: String,
    maybe_text: Option<String>,
    number: i64,
    maybe_number: Option<i64>,
    truth: bool,
    maybe_truth: Option<bool>,
    list: Vec<i64>,
}

impl Row for Sample {
    const SCHEMA: &'static str = "message sample {
        REQUIRED BINARY text (STRING);
        OPTIONAL BINARY maybe_text (STRING);
        REQUIRED INT64 number;
        OPTIONAL INT64 maybe_number;
        REQUIRED BOOLEAN truth;
        OPTIONAL BOOLEAN maybe_truth;
        REQUIRED group list (LIST) { REPEATED group list { REQUIRED INT64 element; } }
    }";

    fn into_cells(self) -> Vec<Cell> {
        vec![
            Cell::Text(Some(self.text)),
            Cell::Text(self.maybe_text),
            Cell::Number(Some(self.number)),
            Cell::Number(self.maybe_number),
            Cell::Truth(Some(self.truth)),
            Cell::Truth(self.maybe_truth),
            Cell::Numbers(self.list),
        ]
    }
}

fn written(rows: &[Sample]) -> Vec<u8> {
    let mut table = Table::new(Vec::new()).unwrap();
    for row in rows {
        table.push(row.clone()).unwrap();
    }
    let (bytes, count) = table.finish().unwrap();
    assert_eq!(usize::try_from(count).unwrap(), rows.len());
    bytes
}

fn read(bytes: &[u8]) -> (Vec<Sample>, usize) {
    let reader = opened(bytes);
    let groups = reader.num_row_groups();
    let rows = reader.get_row_iter(None).unwrap();
    let samples = rows.map(|row| sample(&row.unwrap().into_columns())).collect();
    (samples, groups)
}

fn opened(bytes: &[u8]) -> SerializedFileReader<File> {
    let mut file = tempfile::tempfile().unwrap();
    file.write_all(bytes).unwrap();
    SerializedFileReader::new(file).unwrap()
}

fn sample(columns: &[(String, Field)]) -> Sample {
    let text = |at: usize| match &columns[at].1 {
        Field::Str(text) => Some(text.clone()),
        Field::Null => None,
        other => panic!("{other}"),
    };
    let number = |field: &Field| match field {
        Field::Long(number) => Some(*number),
        Field::Null => None,
        other => panic!("{other}"),
    };
    let truth = |at: usize| match &columns[at].1 {
        Field::Bool(truth) => Some(*truth),
        Field::Null => None,
        other => panic!("{other}"),
    };
    let Field::ListInternal(list) = &columns[6].1 else { panic!("{}", columns[6].1) };
    Sample {
        text: text(0).unwrap(),
        maybe_text: text(1),
        number: number(&columns[2].1).unwrap(),
        maybe_number: number(&columns[3].1),
        truth: truth(4).unwrap(),
        maybe_truth: truth(5),
        list: list.elements().iter().map(|element| number(element).unwrap()).collect(),
    }
}

fn samples() -> impl Strategy<Value = Sample> {
    let list = prop::collection::vec(any::<i64>(), 0..4);
    let values = (any::<String>(), any::<Option<String>>(), any::<i64>(), any::<Option<i64>>());
    (values, any::<bool>(), any::<Option<bool>>(), list).prop_map(
        |((text, maybe_text, number, maybe_number), truth, maybe_truth, list)| Sample {
            text,
            maybe_text,
            number,
            maybe_number,
            truth,
            maybe_truth,
            list,
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn rows_come_back_as_they_were_written(rows in prop::collection::vec(samples(), 0..40)) {
        prop_assert_eq!(read(&written(&rows)).0, rows);
    }
}

#[test]
fn rows_are_written_in_groups_so_that_few_are_held_back() {
    let row = |nth: i64| Sample {
        text: format!("row {nth}"),
        maybe_text: None,
        number: nth,
        maybe_number: (nth % 3 == 0).then_some(nth),
        truth: nth % 2 == 0,
        maybe_truth: None,
        list: vec![nth; usize::try_from(nth % 3).unwrap()],
    };
    let group = i64::try_from(ROWS_IN_GROUP).unwrap();
    for (rows, groups) in [(0, 0), (1, 1), (group, 1), (group + 1, 2), (2 * group + 1, 3)] {
        let rows: Vec<_> = (0..rows).map(row).collect();
        let (found, in_groups) = read(&written(&rows));
        assert_eq!(in_groups, groups);
        assert!(found == rows, "{} rows", rows.len());
    }
}

#[test]
fn a_row_that_is_not_as_the_schema_says_is_refused() {
    struct Wrong(Vec<Cell>);
    impl Row for Wrong {
        const SCHEMA: &'static str = "message m { REQUIRED INT64 a; OPTIONAL BINARY b (STRING); }";
        fn into_cells(self) -> Vec<Cell> {
            self.0
        }
    }
    let refused = |cells: Vec<Cell>| match Table::new(Vec::new()).unwrap().push(Wrong(cells)) {
        Err(TableError::NotAsInSchema { column }) => column,
        other => panic!("{other:?}"),
    };
    let (one, text) = (Cell::Number(Some(1)), Cell::Text(None));
    assert_eq!(refused(vec![one.clone()]), 1);
    assert_eq!(refused(vec![Cell::Number(None), text.clone()]), 0);
    assert_eq!(refused(vec![one.clone(), one.clone()]), 1);
    assert_eq!(refused(vec![Cell::Numbers(vec![1]), text.clone()]), 0);
    assert_eq!(refused(vec![one, text.clone(), text]), 2);
}

/// Files without rows are files all the same: a query on them finds nothing, not an error.
#[test]
fn empty_tables_have_their_columns() {
    let (files, counts) = Tables::new([Vec::new(), Vec::new(), Vec::new()]).unwrap().finish().unwrap();
    assert_eq!((counts.traces, counts.decisions, counts.rounds), (0, 0, 0));
    for (bytes, schema) in files.into_iter().zip([schema::TRACES, schema::DECISIONS, schema::ROUNDS]) {
        let reader = opened(&bytes);
        let found = reader.metadata().file_metadata().schema();
        assert_eq!(*found, parse_message_type(schema).unwrap());
    }
}

/// What is personal of a round (what was disclosed, what it is worth) has no column, and
/// neither has a name.
#[test]
fn no_column_is_personal() {
    let columns: Vec<String> = [schema::TRACES, schema::DECISIONS, schema::ROUNDS]
        .iter()
        .flat_map(|schema| parse_message_type(schema).unwrap().get_fields().to_vec())
        .map(|column| column.name().to_owned())
        .collect();
    insta::assert_snapshot!(columns.join(" "));
}
