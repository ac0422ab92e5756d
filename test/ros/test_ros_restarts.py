"""Nodes are killed, started again and ended early, and the graph goes on."""

import csv
import signal
import subprocess
import sys

from geoprim_ros.endurance.kills import write_bag

PLAYER = "geoprim_ros.nodes.bag_player"
STAGES = ("edges", "polygons", "ellipses")


def command(module, *words):
    """Run a trial as a user does."""
    line = [sys.executable, "-m", f"geoprim_ros.endurance.{module}", *map(str, words)]
    return subprocess.run(line, capture_output=True, text=True, timeout=500)


def test_killed_stages_that_start_again_are_taken_up_again(graph, feed, disc_message):
    processes = {s: graph.start(f"geoprim_ros.nodes.{s}_node") for s in STAGES}
    feed.wait("ellipses", "detections")
    got, message = feed.got["detections"], disc_message(1)

    def answered(count):  # frames flow all the time, as from a camera
        message.header.stamp.nanosec += 1
        feed.images.publish(message)
        graph.spin_for(0.1)
        return len(got) > count

    # A writer of every topic says nothing of who has found whom between the other processes.
    graph.spin_until(lambda: answered(0), 60.0, "the first result")
    for victim in STAGES:
        processes[victim].kill()
        processes[victim].wait()
        processes[victim] = graph.start(f"geoprim_ros.nodes.{victim}_node")
        graph.spin_for(0.3)  # what was on its way
        before = len(got) + 3
        graph.spin_until(lambda n=before: answered(n), 90.0, victim)
        assert [p.poll() for p in processes.values()] == [None] * 3
    for process in processes.values():
        process.send_signal(signal.SIGINT)
    graph.spin_until(lambda: all(p.poll() is not None for p in processes.values()), 60.0)
    assert {name: p.returncode for name, p in processes.items()} == dict.fromkeys(STAGES, 0)


def test_a_player_that_ends_early_leaves_the_graph_to_the_next_one(graph, feed, tmp_path):
    write_bag(tmp_path / "frames.mcap")
    process = graph.start("geoprim_ros.nodes.detector_node")
    graph.spin_until(lambda: feed.node.count_publishers("detections"), 120.0)
    got = feed.got["detections"]
    ends = {signal.SIGINT: 0, signal.SIGKILL: -9, signal.SIGTERM: 0}
    for number, code in ends.items():
        player = graph.start(PLAYER, tmp_path / "frames.mcap", "--loop", "--wait-for-readers", 1)
        before = len(got) + 3
        graph.spin_until(lambda n=before: len(got) > n, 60.0)
        player.send_signal(number)
        graph.spin_until(lambda p=player: p.poll() is not None, 60.0)
        assert player.returncode == code
        graph.spin_for(0.3)
    assert process.poll() is None


def test_two_graphs_on_two_domains_do_not_mix(graph, feed, other_feed, disc_message):
    feeds = {"left": feed, "right": other_feed}
    for each in feeds.values():
        each.graph.start("geoprim_ros.nodes.pipeline", "--stages", "detector")
    for each in feeds.values():
        each.wait("contours", "ellipses", "detections")
    for stamp in range(1, 6):
        for name, each in feeds.items():
            message = disc_message(stamp)
            message.header.frame_id = name
            each.images.publish(message)
            for other in feeds.values():
                other.graph.spin_for(0.05)
            each.graph.spin_until(lambda e=each, n=stamp: len(e.got["detections"]) >= n)
    for name, each in feeds.items():
        each.graph.spin_for(0.2)
        for topic in ("contours", "ellipses", "detections"):
            came = [(m.header.frame_id, m.header.stamp.nanosec) for m in each.got[topic]]
            assert came == [(name, stamp) for stamp in range(1, 6)], topic


def test_the_command_kills_and_starts_again():
    answer = command("kills", "recorder")
    assert answer.returncode == 0, answer.stdout + answer.stderr
    rows = [line for line in answer.stdout.splitlines() if line.endswith("| ok |")]
    assert [row.split(" | ")[0] for row in rows] == ["| recorder"]
    assert command("kills", "nobody").returncode == 2


def test_the_command_starts_and_ends():
    answer = command(
        "starts", "--count", 3, "--together", 3, "--kinds", "edges", "pipeline", "player"
    )
    assert answer.returncode == 0, answer.stdout + answer.stderr
    for kind in ("edges", "pipeline", "player"):
        assert f"| {kind} | 1 of 1 | 0 of 0 |" in answer.stdout


def test_the_soak_writes_samples_and_a_picture(tmp_path):
    words = ("--frames", 120, "--warm-up", 30, "--every", 10, "--limit", 1e9, "--output", tmp_path)
    answer = command("soak", *words)
    assert answer.returncode in (0, 1), answer.stderr  # a thread may still come so early
    assert "exit codes: {'edges': 0, 'polygons': 0, 'ellipses': 0}" in answer.stdout
    with (tmp_path / "soak.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert {row["process"] for row in rows} == {*STAGES, "this one"}
    assert len(rows) == 4 * 12
    assert all(float(row["resident"]) > 20 and int(row["threads"]) > 1 for row in rows)
    assert (tmp_path / "soak.png").read_bytes().startswith(b"\x89PNG")
