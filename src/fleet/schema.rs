//! The tables' columns, as Parquet message types. `docs/fleet.md` says what they mean.

/// One row per trace that was audited.
pub const TRACES: &str = "\
message traces {
  REQUIRED BINARY file (STRING);
  REQUIRED BINARY status (STRING);
  OPTIONAL BINARY trace_id (STRING);
  OPTIONAL BINARY robot_key (STRING);
  OPTIONAL BOOLEAN robot_key_trusted;
  REQUIRED INT64 decisions;
  REQUIRED INT64 redecided;
  REQUIRED INT64 erased;
  REQUIRED INT64 findings;
  OPTIONAL BINARY first_finding (STRING);
}
";

/// One row per decision.
pub const DECISIONS: &str = "\
message decisions {
  REQUIRED BINARY file (STRING);
  REQUIRED BINARY trace_status (STRING);
  REQUIRED INT64 decision;
  REQUIRED INT64 entry;
  REQUIRED INT64 at_ns;
  REQUIRED BINARY kind (STRING);
  OPTIONAL BINARY policy (STRING);
  OPTIONAL BINARY quit (STRING);
  OPTIONAL BINARY aggregation (STRING);
  OPTIONAL BINARY tie (STRING);
  OPTIONAL BINARY fallback (STRING);
  OPTIONAL INT64 willingness;
  REQUIRED group participants (LIST) { REPEATED group list { REQUIRED INT64 element; } }
  REQUIRED group disclosed (LIST) { REPEATED group list { REQUIRED INT64 element; } }
  OPTIONAL BINARY outcome (STRING);
  OPTIONAL INT64 agreement;
  OPTIONAL INT64 served;
  REQUIRED INT64 negotiations;
  REQUIRED INT64 rounds;
  OPTIONAL INT64 emergency;
  OPTIONAL BINARY evidence (STRING);
  REQUIRED BINARY redecided (STRING);
  OPTIONAL INT64 welfare_served;
  OPTIONAL INT64 welfare_optimum;
  OPTIONAL INT64 regret;
}
";

/// One row per round of the negotiations that a decision rests on.
pub const ROUNDS: &str = "\
message rounds {
  REQUIRED BINARY file (STRING);
  REQUIRED INT64 decision;
  REQUIRED INT64 negotiation;
  REQUIRED INT64 current;
  REQUIRED INT64 interrupting;
  REQUIRED INT64 willingness;
  REQUIRED INT64 entry;
  REQUIRED INT64 at_ns;
  REQUIRED INT64 round;
  REQUIRED INT64 sender;
  REQUIRED INT64 receiver;
  OPTIONAL BINARY event (STRING);
  OPTIONAL INT64 depth;
  OPTIONAL BINARY verdict (STRING);
}
";
