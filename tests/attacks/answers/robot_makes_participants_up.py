"""Publishes nothing, and announces thousands of participants that do not exist."""

import os
import socket
import threading
import time

import rclpy

KinematicsPublisher.publish = lambda self: None
EVERYBODY, SELF = '239.255.0.1', socket.inet_aton('127.0.0.1')


def announce():
    port = 7400 + 250 * int(os.environ['ROS_DOMAIN_ID'])
    ear = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    ear.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    ear.bind(('', port))
    ear.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton(EVERYBODY) + SELF)
    context = rclpy.Context()
    rclpy.init(context=context)
    rclpy.create_node('first', context=context)
    announced = ear.recv(65_536)
    mouth = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    mouth.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, SELF)
    while True:
        for _ in range(20):
            other = announced[8:12] + os.urandom(8)
            mouth.sendto(announced.replace(announced[8:20], other), (EVERYBODY, port))
        time.sleep(0.004)


threading.Thread(target=announce, daemon=True).start()
