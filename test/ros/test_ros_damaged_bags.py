"""The player on a damaged bag: what can be read is played, and the exit code tells."""

import pytest
from std_msgs.msg import Header

from geoprim_core.io.bags import BagReader, BagWriter
from geoprim_core.io.record import header

PLAYER = "geoprim_ros.nodes.bag_player"


@pytest.mark.live
def test_the_player_plays_what_is_left_and_says_what_is_lost(graph, tmp_path):
    path = tmp_path / "bag.mcap"
    with BagWriter(path, chunk_bytes=400) as bag:
        for i in range(60):
            stamp = i * 10_000_000
            bag.write("stamps", header(stamp, f"frame {i} " + "x" * 40), log_time_ns=stamp)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    left = [message.decoded.frame_id for message in BagReader(path).messages()]
    assert 5 < len(left) < 60
    got = []
    graph.node("listener").create_subscription(
        Header, "stamps", lambda message: got.append(message.frame_id), 100
    )
    player = graph.start(PLAYER, path, "--wait-for-readers", 1, "--quiet")
    graph.spin_until(lambda: player.poll() is not None and len(got) >= len(left))
    assert got == left
    assert got[3].startswith("frame 3 ")
    assert player.returncode == 1
    said = player.stderr.read()
    assert "damaged or lost" in said
    assert "Traceback" not in said


@pytest.mark.live
def test_the_player_refuses_a_bag_of_which_nothing_is_left(graph, tmp_path):
    path = tmp_path / "bag.mcap"
    path.write_bytes(b"")
    player = graph.start(PLAYER, path)
    graph.spin_until(lambda: player.poll() is not None)
    assert player.returncode == 2
    assert "0 bytes" in player.stderr.read()
