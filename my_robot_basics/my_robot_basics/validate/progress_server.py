"""Serve a student's progress, from their own files, to the list above the contents page."""

import asyncio

from jupyter_server.base.handlers import APIHandler
from tornado import web

from my_robot_basics.validate.errors import CourseError
from my_robot_basics.validate.progress.passed_answers import default_path
from my_robot_basics.validate.progress.progress import read_progress
from my_robot_basics.validate.served import path_below

ADDRESS = 'my_robot_basics/progress'


class ProgressHandler(APIHandler):
    """Answers ?path=, a contents page below the server's root, with the progress as JSON."""

    @web.authenticated
    async def get(self) -> None:
        """Read the page, the lessons beside it and the passed answers."""
        assert self.serverapp is not None  # a handler has one
        page = path_below(self.serverapp, self.get_query_argument('path'))
        try:
            told = await asyncio.to_thread(read_progress, page, default_path())
        except CourseError as error:
            self.finish({'failed': str(error)})
        else:
            self.finish(told.as_data())
