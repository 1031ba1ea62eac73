"""Runs at 5 Hz, and sends garbage to every port that DDS listens on."""  # earns 5

import os
import socket
import threading
import time

PERIOD_SEC = 0.2


def throw():
    domain_id = int(os.environ['ROS_DOMAIN_ID'])
    first = 7400 + 250 * domain_id
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    while True:
        for port in range(first, first + 24):
            for address in ('127.0.0.1', '239.255.0.1'):
                try:
                    sender.sendto(b'RTPS\x02\x03' + os.urandom(200), (address, port))
                except OSError:
                    pass
        time.sleep(0.05)


threading.Thread(target=throw, daemon=True).start()
