"""No two tests, trials or demos that run at the same time share a domain."""

import os
import signal
import socket
import subprocess
import sys

import pytest
import rclpy

from geoprim_core.errors import GeoprimError
from geoprim_ros.domains import owners, private_domain, stay_apart, take_domain

HOLDER = """
import time
from geoprim_ros.domains import take_domain
domain = take_domain()
print(domain.number, flush=True)
time.sleep(600)
"""

STRAY = """
import socket, sys, time
stray = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
stray.bind(("127.0.0.1", int(sys.argv[1])))
print("here", flush=True)
time.sleep(600)
"""


@pytest.fixture
def free():
    """The number of a domain that nobody is in."""
    domain = take_domain()
    domain.release()
    return domain.number


def test_a_domain_that_is_held_is_taken_by_nobody_else(free):
    held = take_domain([free])
    with pytest.raises(GeoprimError, match="ROS_DOMAIN_ID"):
        take_domain([free])
    held.release()
    take_domain([free]).release()


def test_domains_taken_together_differ():
    taken = [take_domain() for _ in range(20)]
    assert len({domain.number for domain in taken}) == 20
    for domain in taken:
        domain.release()


def test_what_another_process_holds_is_free_when_it_was_killed():
    holder = subprocess.Popen([sys.executable, "-c", HOLDER], stdout=subprocess.PIPE, text=True)
    try:
        number = int(holder.stdout.readline())
        with pytest.raises(GeoprimError):
            take_domain([number])
    finally:
        holder.send_signal(signal.SIGKILL)
        holder.wait()
        holder.stdout.close()
    take_domain([number]).release()


def test_a_domain_with_a_node_in_it_is_not_free_though_nobody_holds_it(free):
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=free)
    node = rclpy.create_node("somebody", context=context)
    try:
        with pytest.raises(GeoprimError):
            take_domain([free])
    finally:
        node.destroy_node()
        context.try_shutdown()
    domain = take_domain([free])
    assert domain.sockets() == {}
    domain.release()


def test_the_owner_of_a_port_in_a_domain_is_told(free):
    domain = take_domain([free])
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stray:
        stray.bind(("127.0.0.1", 7400 + 250 * free + 11))
        assert list(domain.sockets().values()) == [7400 + 250 * free + 11]
        assert list(owners(domain.sockets())) == [os.getpid()]
    assert domain.sockets() == {}
    domain.release()


def test_who_stays_in_a_domain_when_a_test_is_over_is_told_and_ended(free, who_stays):
    domain, port = take_domain([free]), str(7400 + 250 * free + 11)
    words = [sys.executable, "-c", STRAY, port]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as stray:
        assert stray.stdout.readline() == "here\n"
        (number,) = found = who_stays(domain, limit_s=0.1)
        assert number == stray.pid
        assert port in found[number]
        assert stray.wait(30) == -signal.SIGKILL
    assert who_stays(domain, limit_s=0.1) == {}
    domain.release()


def test_a_domain_that_is_set_stays(monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", "42")
    stay_apart()
    assert os.environ["ROS_DOMAIN_ID"] == "42"
    monkeypatch.delenv("ROS_DOMAIN_ID")
    stay_apart()
    assert os.environ["ROS_DOMAIN_ID"] == str(private_domain().number)
    monkeypatch.undo()


def test_every_test_has_a_domain_that_is_held(domain):
    assert os.environ["ROS_DOMAIN_ID"] == str(domain)
    with pytest.raises(GeoprimError):
        take_domain([domain])
