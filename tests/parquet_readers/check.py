"""Reads a fleet's tables with DuckDB and holds them against the audit's JSON document.

check.py TABLES AUDIT_JSON QUERIES: every figure of the document is in the tables, and every
```sql block of the Markdown file QUERIES runs and finds something. With --open the tables
were made without an identity.
"""

import collections
import json
import os
import re
import sys

import duckdb

# What the generated users are called, have and want: none of it may be in the tables.
PERSONAL = ["User ", "elderly", "small child", "urgency", "disabled", "anxiety", "health", "pharmacy", "bathroom"]


def expect(holds, what):
    if not holds:
        sys.exit(f"FAILED: {what}")


def rows(query):
    return duckdb.sql(query).fetchall()


def user(number):
    return None if number is None else f"user-{number}"


def traces(document):
    found = {row[0]: row[1:] for row in rows(
        "SELECT file, status, decisions, redecided, findings, erased, robot_key, robot_key_trusted"
        " FROM 'traces.parquet'")}
    expect(len(found) == len(document), f"{len(document)} traces, {len(found)} rows")
    order = [row[0] for row in rows("SELECT file FROM 'traces.parquet'")]
    expect(order == [trace["file"] for trace in document], "rows in the order of the traces")
    for trace in document:
        seal = trace["seal"] or {"key": None, "trusted": None}
        expected = (
            trace["status"], trace["decisions"], trace["redecided"],
            len(trace["findings"]) + trace["more_findings"], len(trace["erased"]),
            seal["key"], seal["trusted"],
        )
        expect(found[trace["file"]] == expected, f"{trace['file']}: {found[trace['file']]}, not {expected}")


def decisions(document):
    found = {}
    for row in rows(
        "SELECT file, decision, trace_status, coalesce(outcome, kind), participants, served, rounds,"
        " redecided, welfare_served, welfare_optimum, regret, at_ns FROM 'decisions.parquet'"
    ):
        found[row[0], row[1]] = row[2:]
    expect(len(found) == sum(trace["decisions"] for trace in document), "a row for each decision")
    for trace in document:
        for one in trace["each_decision"]:
            status, outcome, participants, served, rounds, redecided, *welfare, at_ns = found[
                trace["file"], one["decision"]]
            worth = one["welfare"] or {"served": None, "optimum": None, "regret": None}
            was = (status, outcome, [user(number) for number in participants], user(served), rounds, redecided,
                   welfare, round(at_ns / 1e9, 6))
            expected = (
                trace["status"], one["outcome"], one["participants"], one["served"], one["rounds"],
                one["redecided"], [worth["served"], worth["optimum"], worth["regret"]], round(one["at_s"], 6),
            )
            expect(was == expected, f"{trace['file']}, decision {one['decision']}: {was}, not {expected}")


def rounds():
    odd = rows(
        "SELECT d.file, d.decision, d.rounds, count(r.round) FROM 'decisions.parquet' d"
        " LEFT JOIN 'rounds.parquet' r USING (file, decision) GROUP BY ALL HAVING d.rounds <> count(r.round)")
    expect(not odd, f"as many rows as rounds: {odd[:3]}")
    deepest = rows(
        "SELECT count(*) FROM (SELECT file, decision, unnest(participants) AS sender, unnest(disclosed) AS most"
        " FROM 'decisions.parquet') d LEFT JOIN (SELECT file, decision, sender, max(depth) AS depth"
        " FROM 'rounds.parquet' GROUP BY ALL) r USING (file, decision, sender)"
        " WHERE d.most <> coalesce(r.depth, 0)")
    expect(deepest == [(0,)], "disclosed is the deepest offer")
    ends = rows(
        "SELECT count(*) FROM 'rounds.parquet' WHERE (event = 'offer') <> (depth IS NOT NULL)"
        " OR (event = 'offer') <> (verdict IS NOT NULL)")
    expect(ends == [(0,)], "an offer has a depth and a verdict, a quit has neither")


def nothing_personal():
    for table in ("traces", "decisions", "rounds"):
        for name, kind, *_ in rows(f"DESCRIBE FROM '{table}.parquet'"):
            if kind == "VARCHAR" and name != "file":
                values = [value for (value,) in rows(f'SELECT DISTINCT "{name}" FROM \'{table}.parquet\'') if value]
                for word in PERSONAL:
                    expect(not any(word in value for value in values), f"{table}.{name} holds {word!r}")


def queries(text):
    found = re.findall(r"```sql\n(.*?)```", text, re.DOTALL)
    expect(len(found) >= 3, "queries in the documentation")
    for query in found:
        result = duckdb.sql(query)
        expect(len(result.fetchall()) > 0, f"finds nothing: {query}")
        print(duckdb.sql(query))


def main():
    arguments = [argument for argument in sys.argv[1:] if argument != "--open"]
    folder, audit, markdown = arguments
    with open(audit, encoding="utf-8") as file:
        document = json.load(file)["traces"]
    with open(markdown, encoding="utf-8") as file:
        text = file.read()
    os.chdir(folder)
    traces(document)
    decisions(document)
    rounds()
    nothing_personal()
    if "--open" in sys.argv:
        known = rows("SELECT count(*) FROM 'decisions.parquet' WHERE trace_status = 'ok' AND"
                     " (regret IS NOT NULL OR welfare_served IS NOT NULL OR redecided <> 'unchecked')")
        expect(known == [(0,)], "without an identity no welfare")
    else:
        queries(text)
    statuses = collections.Counter(trace["status"] for trace in document)
    print(f"{len(document)} traces, {sum(trace['decisions'] for trace in document)} decisions,"
          f" {rows('SELECT count(*) FROM ' + repr('rounds.parquet'))[0][0]} rounds agree: {dict(statuses)}")


main()
