"""Opens a trace with Python's mcap and decodes every message by the schemas in the file.

check.py TRACE: a complete trace with what is personal in the open. check.py --cut TRACE: one
without its end. check.py --sealed TRACE: a complete one, sealed and signed.
"""

import collections
import json
import struct
import sys

from mcap.exceptions import McapError
from mcap.reader import NonSeekingReader, make_reader
from mcap.stream_reader import StreamReader
from mcap_protobuf.decoder import DecoderFactory

WELL_KNOWN = {
    "foxglove.FrameTransforms",
    "foxglove.Grid",
    "foxglove.Log",
    "foxglove.PointCloud",
    "foxglove.PoseInFrame",
    "foxglove.SceneUpdate",
}


def expect(holds, what):
    if not holds:
        sys.exit(f"FAILED: {what}")


def complete(path):
    counts, schemas, topics = collections.Counter(), set(), set()
    indices, sequences, people = [], [], set()
    header = end = None
    with open(path, "rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        statistics = reader.get_summary().statistics
        for schema, channel, message, decoded in reader.iter_decoded_messages(log_time_order=False):
            expect(decoded.DESCRIPTOR.full_name == schema.name, f"{channel.topic} decodes as its schema")
            counts[channel.topic] += 1
            schemas.add(schema.name)
            topics.add(channel.topic)
            sequences.append(message.sequence)
            if schema.name in ("selfneg.v1.Event", "selfneg.v1.Record", "selfneg.v1.Command"):
                indices.append(decoded.index)
            elif schema.name == "selfneg.v1.Header":
                header = decoded
            elif schema.name == "selfneg.v1.End":
                end = decoded
            elif schema.name == "selfneg.personal.v1.Participant":
                people.add(decoded.person)
            elif schema.name == "foxglove.Log":
                expect(decoded.message.rstrip('"')[-1:] in tuple('.!?'), f"a sentence: {decoded.message!r}")
                if channel.topic == "/log":
                    named = [person for person in people if person in decoded.message]
                    expect(not named, f"no name in {decoded.message!r}")
            elif schema.name == "foxglove.Grid":
                rows = len(decoded.data) // decoded.row_stride
                expect(rows * decoded.row_stride == len(decoded.data) > 0, "a grid of whole rows")
            elif schema.name == "foxglove.PointCloud":
                expect(len(decoded.data) % decoded.point_stride == 0, "a cloud of whole points")
    expect(header is not None and header.format_major == 1, "a header of format 1")
    expect(len(people) == len(header.participants) > 0, "as many participants as pseudonyms")
    expect(end is not None, "an end")
    expect(indices == list(range(len(indices))), "events and replies are numbered without a gap")
    expect(sequences == list(range(len(sequences))), "messages are numbered without a gap")
    expect(end.messages + 1 == sum(counts.values()) == statistics.message_count, "as many messages as it says")
    expect(end.events == counts["/mission/event"] > 0, "as many events as it says")
    expect(end.events + end.replies == len(indices), "as many replies as it says")
    expect(counts["/mission/decision"] > 0 and counts["/personal/reply"] > 0, "decisions, and their personal part")
    expect(schemas >= WELL_KNOWN, f"what people look at: {sorted(WELL_KNOWN - schemas)} missing")
    expect(all(topic.startswith("/") for topic in topics), "topics begin with a slash")
    print(json.dumps({"messages": sum(counts.values()), "topics": len(topics), "decisions": end.decisions}))


def cut(path):
    decoders, counts = {}, collections.Counter()
    schemas, channels = {}, {}
    with open(path, "rb") as file:
        try:
            for record in StreamReader(file, validate_crcs=True).records:
                kind = type(record).__name__
                if kind == "Schema":
                    schemas[record.id] = record
                elif kind == "Channel":
                    channels[record.id] = record
                elif kind == "Message":
                    channel = channels[record.channel_id]
                    schema = schemas[channel.schema_id]
                    if channel.id not in decoders:
                        decoders[channel.id] = DecoderFactory().decoder_for("protobuf", schema)
                    decoders[channel.id](record.data)
                    counts[channel.topic] += 1
        except (McapError, EOFError, struct.error) as error:
            expect(sum(counts.values()) > 0, "messages before the cut")
            print(json.dumps({"messages": sum(counts.values()), "then": type(error).__name__}))
            return
    expect(False, "the cut is seen")


def sealed(path):
    counts, bare, subjects = collections.Counter(), [], set()
    with open(path, "rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        for schema, channel, message, decoded in reader.iter_decoded_messages(log_time_order=False):
            counts[channel.topic] += 1
            expect(decoded.DESCRIPTOR.full_name == schema.name, f"{channel.topic} decodes as its schema")
            if channel.topic.startswith("/personal/"):
                bare.append(channel.topic)
            if schema.name == "selfneg.v1.Sealed":
                subjects.add(decoded.subject)
                expect(decoded.ciphertext.startswith(b"age-encryption.org/v1\n"), "a segment is an age file")
            elif schema.name == "foxglove.Log":
                expect('"' not in decoded.message, f"no name in {decoded.message!r}")
        notes = collections.Counter(note.name for note in reader.iter_metadata())
    expect(not bare, f"nothing personal in the open: {bare}")
    expect({"everyone", "several"} < subjects, f"segments of people: {subjects}")
    expect(counts["/mission/commitment"] > 0, "commitments")
    expect(notes["selfneg.seal"] == 1 and notes["selfneg.checkpoint"] >= 3, f"a seal and checkpoints: {notes}")
    print(json.dumps({"messages": sum(counts.values()), "subjects": len(subjects), "notes": dict(notes)}))


if sys.argv[1] == "--cut":
    cut(sys.argv[2])
elif sys.argv[1] == "--sealed":
    sealed(sys.argv[2])
else:
    complete(sys.argv[1])
