"""What nbgrader's own commands and the formgrader need to know: they work in this folder too.

Instructors open the formgrader with `.venv/bin/jupyter lab`, started in this folder.
"""

from pathlib import Path

try:
    from grader.authoring.release_passes import CODE_STUB, PASSES
    from grader.autograde.locking import lock_while_grading
    from grader.autograde.submitted_files import files_of_solved_packages, read_timestamps_as_we_do
    from grader.common.errors import CourseError
    from grader.common.logs import NBGRADER_LOGGING
    from grader.course import Course
    from grader.report.feedback import FEEDBACK_PASSES
    from grader.report.formgrader import FILTERS, OUTPUT_KINDS
    from grader.storage.database import make_ready
    from grader.storage.pipeline import AUTOGRADE_PASSES, SANITIZE_PASSES

    course = Course.at(Path(__file__).parent)
    try:
        db_url = course.db_url  # in SQLite, or what gradebook/database.toml says
        make_ready(course)
        solved_packages = files_of_solved_packages(course)
    except CourseError as problem:
        raise SystemExit(f'course: {problem}') from None
    read_timestamps_as_we_do()
    lock_while_grading()
except (ImportError, OSError) as error:
    # nbgrader would go on with its defaults, which let a submission choose its own score
    raise SystemExit(
        f'{error}: without its grader this course would be graded unprotected. '
        'Run ./course test once, and use .venv/bin/nbgrader.'
    ) from None

c = get_config()  # noqa: F821

c.NbGrader.logging_config = NBGRADER_LOGGING  # names of folders may move the cursor

c.CourseDirectory.root = str(course.root)
c.CourseDirectory.source_directory = 'solutions'
c.CourseDirectory.release_directory = 'notebooks'
c.CourseDirectory.submitted_directory = 'gradebook/submitted'
c.CourseDirectory.autograded_directory = 'gradebook/autograded'
c.CourseDirectory.feedback_directory = 'gradebook/feedback'
c.CourseDirectory.db_url = db_url

c.GenerateAssignment.preprocessors = list(PASSES)
c.ClearSolutions.code_stub = CODE_STUB
# a mark scheme stands in the text before an answer: the grader puts that back from the source
c.ClearMarkScheme.enforce_metadata = False
c.Autograde.exporter_class = 'grader.autograde.submitted_files.AutogradeExporter'
c.Autograde.sanitize_preprocessors = list(SANITIZE_PASSES)
c.Autograde.autograde_preprocessors = list(AUTOGRADE_PASSES)
c.Autograde.exclude_overwriting = solved_packages
c.Autograde.pre_convert_hook = 'grader.storage.gradebook.register_before_autograde'
c.ExchangeFactory.collect = 'grader.collect.nbgrader_collect.CollectAsWeDo'
c.ExchangeFactory.release_feedback = 'grader.serving.nbgrader_release.ReleaseAsWeDo'
c.GenerateFeedback.preprocessors = list(FEEDBACK_PASSES)
c.GenerateFeedback.exporter_class = 'grader.report.feedback.FeedbackPage'
c.ExportApp.plugin_class = 'grader.export.nbgrader_export.CsvExport'

# the formgrader shows what students wrote: nothing of it may run there
c.HTMLExporter.sanitize_html = True
c.HTMLExporter.filters = FILTERS
c.NbConvertBase.display_data_priority = OUTPUT_KINDS
