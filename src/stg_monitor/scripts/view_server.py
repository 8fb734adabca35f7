#!/usr/bin/python3
"""Serves the live view of a run to browsers on the loopback.

It only listens. It stores at most rate_hz steps per second of wall time, and packets (stg_view/listening.py). While
no browser is connected, making steps takes at most the share unseen_share of a processor.
A browser that connects late first gets everything that was stored.
ssh -L 8300:127.0.0.1:8300 HOST brings the page to another machine.
"""

import stg_common.quiet_start  # first import: Ctrl-C is blocked until here, see graph.launch
import asyncio
import difflib
import os
import re
import threading

import rospy
from aiohttp import WSMsgType, web
import stg_common.program
from stg_view.listening import UNSEEN_SHARE, Listener
from stg_view.page import PageError, live_page
from stg_view.recording import encode

HOST = "127.0.0.1"
PARAMETERS = ("nice", "port", "rate_hz", "unseen_share")  # private ones
# The nodes of a run in lockstep wait for each other. This node works while they leave a processor idle.
NICE = 19
# Only pages of this machine may connect. Another site in the same browser has another origin and host.
OWN = re.compile(r"(127\.0\.0\.1|localhost|\[::1\])(:\d+)?$")


class Server:
    """The page and its websocket, in their own thread."""

    def __init__(self, port, rate_hz, unseen_share):
        self.loop = asyncio.new_event_loop()
        self.sockets = {}
        self.page = live_page("live run").encode()
        self.port = port
        self.listener = Listener(rate_hz, self.send, self.later, lambda: bool(self.sockets), unseen_share)
        self.failure = None
        self.ready = threading.Event()
        threading.Thread(target=self.serve, daemon=True).start()
        self.ready.wait(10.0)

    def serve(self):
        """Runs the loop."""
        asyncio.set_event_loop(self.loop)
        app = web.Application(middlewares=[own_only])
        app.add_routes([web.get("/", self.get_page), web.get("/stream", self.get_stream), web.get("/alive", get_alive)])
        try:
            runner = web.AppRunner(app, access_log=None)
            self.loop.run_until_complete(runner.setup())
            self.loop.run_until_complete(web.TCPSite(runner, HOST, self.port).start())
        except OSError as error:
            self.failure = error
            self.ready.set()
            return
        self.ready.set()
        self.loop.run_forever()

    async def get_page(self, _request):
        """The page."""
        headers = {"Cache-Control": "no-store", "X-Frame-Options": "DENY"}
        return web.Response(body=self.page, content_type="text/html", charset="utf-8", headers=headers)

    async def get_stream(self, request):
        """Serves a browser until it disconnects."""
        socket = web.WebSocketResponse(heartbeat=20.0, compress=False)
        await socket.prepare(request)
        queue = asyncio.Queue(400)
        with self.listener.lock:
            history = encode("meta", meta={"sent_s": 0}) + self.listener.history()
            self.sockets[socket] = queue
        writer = self.loop.create_task(write(socket, history, queue))
        try:
            async for message in socket:
                if message.type == WSMsgType.ERROR:
                    break
        finally:
            writer.cancel()
            self.sockets.pop(socket, None)
        return socket

    def later(self, seconds, action):
        """Lets the loop call an action later; from any thread."""
        self.loop.call_soon_threadsafe(self.loop.call_later, seconds, action)

    def send(self, data):
        """Sends a message to all browsers; from any thread."""
        if self.sockets:
            self.loop.call_soon_threadsafe(self.put, data)

    def put(self, data):
        """Queues a message for all browsers. A slow browser misses messages; the run never waits."""
        for queue in list(self.sockets.values()):
            if not queue.full():
                queue.put_nowait(data)


async def write(socket, history, queue):
    """Sends the stored messages, then new ones, in as few frames as possible."""
    await socket.send_bytes(history)
    while True:
        data = [await queue.get()]
        while not queue.empty():
            data.append(queue.get_nowait())
        await socket.send_bytes(b"".join(data))


async def get_alive(_request):
    """Answers a page that asks if a new run is there."""
    return web.Response(text="yes")


@web.middleware
async def own_only(request, handler):
    """Refuses requests with other host names or from pages of other sites."""
    origin = request.headers.get("Origin", "")
    if not OWN.match(request.headers.get("Host", "")) or (origin and not OWN.match(origin.partition("//")[2])):
        raise web.HTTPForbidden(text="This page is for this machine only.")
    return await handler(request)


def require_known_parameters():
    """Refuses private parameters that this node does not read, as the nodes in C++ do."""
    space = rospy.get_name() + "/"
    for path in rospy.get_param_names():
        name = path[len(space):]
        if not path.startswith(space) or name in PARAMETERS:
            continue
        near = difflib.get_close_matches(name, PARAMETERS, 1)
        meant = f", did you mean {near[0]}?" if near else ""
        raise PageError(f"parameter {name}: this node does not read it{meant} ('rosparam delete {path}' "
                        "removes it from the ROS master)")


def main():
    """Runs until ROS ends it."""
    # It only uses the wall clock, because a run in lockstep sends /clock at every step.
    rospy.init_node("view_server", disable_signals=False, disable_rostime=True)
    require_known_parameters()
    port, rate_hz = rospy.get_param("~port", 8300), rospy.get_param("~rate_hz", 10.0)
    if not (isinstance(port, int) and 1 <= port <= 65535 and isinstance(rate_hz, (int, float)) and 0.1 <= rate_hz <= 100):
        raise PageError(f"port {port} or rate_hz {rate_hz} is out of range: a port is 1 to 65535, a rate 0.1 to 100")
    share = rospy.get_param("~unseen_share", UNSEEN_SHARE)
    if not (isinstance(share, (int, float)) and 0.001 <= share <= 1):
        raise PageError(f"unseen_share {share} is out of range: it is 0.001 to 1")
    nice = rospy.get_param("~nice", NICE)
    if not (isinstance(nice, int) and 0 <= nice <= 19):
        raise PageError(f"nice {nice} is out of range: it is 0 to 19")
    os.nice(nice)
    server = Server(port, float(rate_hz), float(share))
    if server.failure:
        raise PageError(f"port {port} of {HOST}: {server.failure.strerror}; choose another one with port:=")
    print(f"view: http://{HOST}:{port}", flush=True)
    rospy.spin()
    return 0


if __name__ == "__main__":
    stg_common.program.run_program("view_server", main, PageError)
