"""Which cases of tests with many similar cases `./course test` runs; `--slow` runs all.

If a test that starts something (tests/tiers.py) has several cases, an ordinary run takes only the
first. A row of the table chooses others: a regular expression for the test ids in brackets. One
right and one wrong case of each check, and one attack on each kind of limit, stay in it. A slow
test with a faster one for the same behaviour has the mark `slow` in its own file.
"""

import re
from collections import defaultdict

import pytest

ATTACKS = (
    # what the sandbox forbids, limits or hides
    r'fork_bomb|makes_rare_system_calls|network_out|reads_the_seed'
    # what the grader accepts
    r'|forges_a_verdict|html_and_escapes|patches_what_checks_use|edits_its_checks'
)
ALL = r'.*'
FEW = 1
"""How many cases are run of a test without a row."""
ORDINARY = {
    # they are quick, and each tests another limit or another kind of end
    'test_sandbox_share::test_a_room_can_use_up_only_its_share': ALL,
    'test_sandbox::test_private_files_of_the_course_and_the_machine_are_not_in_a_room': ALL,
    'test_kernels::test_a_cell_ends_and_its_kernel_stays_alive': ALL,
    'test_kernel_exits::test_students_are_responsible_only_for_endings_shown_as_theirs': ALL,
    'test_rooms_hostile::test_a_reply_is_read_only_if_it_is_a_single_string_literal': ALL,
    'test_checks_delivery_experiment::test_messages_arrive_only_if_topic_name_and_type_match': ALL,
    'test_sample_class::test_a_sample_earns_its_expected_points_for_the_expected_reasons': ALL,
    'test_readme::test_links_and_pictures_lead_to_existing_files': ALL,
    # each lesson is also run by nbval and by Validate
    'test_lessons_run::test_an_unanswered_lesson_fails_in_its_checks_alone_and_says_what_is_missing': (  # noqa: E501
        r'03_publisher'
    ),
    'test_browser::test_run_all_runs_an_unanswered_lesson_to_its_end': r'02_joint_state',
    'test_attacks::test_an_attack_earns_only_the_points_of_its_honest_work': ATTACKS,
    'test_attacks::test_an_attack_reveals_neither_hidden_tests_nor_the_seed': ATTACKS,
    'test_kernel_exits::test_a_kernel_ended_from_outside_is_ungraded_and_not_zero': (
        r'forked-in a cell-kill'
    ),
    'test_kernel_exits::test_a_kernel_ended_once_from_outside_is_graded_in_fresh_rooms': (
        r'in a cell'
    ),
    'test_kernel_exits::test_an_answer_that_ends_its_own_kernel_fails_with_the_reason': (
        r'forked-(os\._exit|SIGKILL)'
    ),
    'test_kernel_exits::test_an_answer_that_ends_its_own_node_fails': (
        r'(forked|started)-node\.kill.*|forked-import os.*'
    ),
    'test_checks_sampling::test_a_wrong_rate_fails': r'a_little_fast-.*',
    'test_checks_sampling::test_honest_nodes_that_are_no_plain_timers_pass': r'sleep_loop-.*',
    # one right and one wrong node for each check of an action, a service, a parameter
    'test_checks_actions::test_each_correct_action_server_passes': r'MoveArmServer',
    'test_checks_actions_wrong::test_a_mistake_fails_the_expected_checks_and_names_its_cause': (
        r'NoFeedback-.*'
    ),
    'test_checks_action_servers::test_each_correct_way_to_send_goals_passes': r'MoveArmClient',
    'test_checks_action_servers_wrong::test_a_wrong_outcome_fails_with_its_cause': (
        r'AlwaysSucceeded-.*'
    ),
    'test_checks_action_servers_wrong::test_a_wrong_cancel_fails_only_the_check_of_cancels': (
        r'NeverCancels-.*'
    ),
    'test_checks_player::test_each_correct_way_to_visit_targets_passes': r'Usual|Callbacks',
    'test_checks_player::test_each_wrong_program_fails_with_its_cause': (
        r'StopsAtTheFirstUnreachable|SendsAllGoalsAtOnce|CallsInACallback'
    ),
    'test_checks_services::test_a_wrong_solution_is_named': r'(Degrees|Swapped)-.*',
    'test_checks_services::test_each_correct_service_passes': r'IKService|Coroutine',
    'test_checks_servers::test_each_correct_way_to_call_a_service_passes': r'IKClient',
    'test_checks_wrong_clients::test_each_wrong_client_is_reported_with_its_fault': (
        r'(ElbowDown|AsksNobody)-.*'
    ),
    'test_checks_waiting_clients::test_waiting_inside_a_callback_fails_with_the_cause': r'Calls',
    'test_doctor_service_faults::test_a_client_that_blocks_its_executor_is_reported_and_fixed': (
        r'call'
    ),
    'test_doctor_service_healthy::test_no_fault_is_found_in_a_client_of_a_quick_or_slow_server': (
        r'add_done_callback-2\.0'
    ),
    'test_checks_topics::test_a_node_of_the_same_kernel_is_judged_exactly': r'FiveHz',
    'test_checks_wrong_clients::test_a_client_that_publishes_more_than_the_response_is_reported': (
        r'BothBranches-.*'
    ),
    'test_checks_waiting_clients::test_a_client_that_never_gets_an_answer_fails_with_the_cause': (
        r'Calls'
    ),
    'test_doctor_actions::test_a_goal_that_ends_wrongly_or_not_at_all_is_reported': r'Forgets-.*',
    'test_doctor_actions::test_each_state_of_a_stalled_goal_has_its_own_fix': r'executing-.*',
    'test_checks_actions_absent::test_a_missing_action_server_fails_with_its_likely_cause': (
        r'arguments0-.*'
    ),
    'test_checks_services::test_a_missing_server_fails_with_its_likely_cause': r'arguments0-.*',
    'test_package::test_the_ament_index_finds_each_node_of_a_colcon_build': r'options0',
    'test_sandbox::test_a_room_can_write_only_to_its_own_temporary_folders': r'forked',
    # the same commands with other options
    'test_ros2_action::test_action_verbs_print_the_output_of_ros2cli': r'[a-z]+( [^-\s]\S*)*',
    'test_ros2_action::test_invalid_action_arguments_are_refused_as_by_ros2cli': (
        r'(type|info) .*|.*(path|\[1\])'
    ),
    'test_ros2_graph::test_graph_verbs_print_the_output_of_ros2cli': (
        r'[a-z]+ (list|info)( [^-\s]\S*)?'
    ),
    'test_ros2_graph::test_unknown_names_are_refused_as_by_ros2cli': (
        r'(topic info|node info|param list) .*'
    ),
    'test_ros2_param::test_param_verbs_print_the_output_of_ros2cli': (
        r'(list|get|dump) [^-\s]\S*( [^-\s]\S*)?'
    ),
    'test_ros2_param::test_unknown_nodes_files_and_parameters_are_refused_as_by_ros2cli': (
        r'(get|load) .*'
    ),
    'test_ros2_param::test_a_refusal_by_the_node_is_printed_with_its_reason': r'set .*',
    'test_ros2_service::test_service_verbs_print_the_output_of_ros2cli': (
        r'(list|info)( [^-\s]\S*)?'
    ),
    'test_ros2_service::test_invalid_service_arguments_are_refused_as_by_ros2cli': (
        r'(info|call //x) .*|.*(path|\[1\])'
    ),
    'test_ros2_streams::test_an_endless_verb_ends_when_its_output_is_closed': r'echo|hz|pub',
    'test_ros2_streams::test_a_signal_ends_an_endless_verb_silently_with_the_status_of_ros2cli': (
        r'echo|hz|pub'
    ),
    'test_ros2_streams::test_echo_prints_the_output_of_ros2cli': (
        r'/kinematics/joint_states( --(csv|field position|include-message-info))?'
    ),
    'test_ros2_streams::test_invalid_topic_arguments_are_refused_in_a_sentence': (
        r'(echo|hz|bw) .*'
    ),
    # one lesson, one page
    'test_accessibility::test_a_released_lesson_is_accessible': r'03_publisher/.*|index\.ipynb',
    # the same fault, or the same kind of end, in another form
    'test_doctor_faults::test_a_planted_fault_in_a_line_is_reported_first_and_fixed': (
        r'best effort'
    ),
    'test_doctor_healthy::test_no_fault_is_found_in_half_a_dozen_healthy_systems': r'1',
    'test_environment::test_a_resolver_adds_nothing_to_the_pins_and_finds_a_wheel_of_each': (
        r'3\.11'
    ),
    'test_fork_servers::test_a_kernel_that_cannot_be_forked_is_started_and_says_why': r'a thread',
    'test_kernels::test_a_kernel_that_dies_is_noticed': r'_exit|SIGKILL',
    'test_kernel_messages::test_a_flood_is_drained_and_bounded_and_the_kernel_goes_on': (
        r'one huge text|many displays'
    ),
    'test_release::test_work_in_a_release_is_copied_before_the_release_is_replaced': r'answer',
    'test_executables::test_a_signal_ends_a_spinning_executable_cleanly': (
        r'hello_node-15|kinematics_publisher-2'
    ),
    'test_executables::test_a_signal_at_any_moment_ends_a_node': r'.*SIGINT',
    'test_live_interrupts::test_a_cell_that_spins_for_ever_can_be_interrupted': (
        r'rclpy\.spin\(node\)'
    ),
    'test_live_kernel_ends::test_unruly_nodes_do_not_abort_the_kernel_when_it_ends': (
        r'never_returns'
    ),
    'test_checks_topics::test_a_wrong_message_fails': r'Degrees-.*',
    'test_checks_topics::test_an_unusable_reply_counts_as_an_existing_endpoint': r'None',
    'test_checks_logs::test_a_near_miss_fails_with_its_fault': r'ik_one_branch-.*',
    'test_checks_relays::test_a_monitor_passes_silently_with_any_offered_qos_profile': (
        r'RELIABLE VOLATILE'
    ),
    'test_checks_relays_lost::test_a_relay_that_loses_delays_or_repeats_messages_fails': (
        r'Lags-.*'
    ),
    'test_kernel_exits::test_a_node_ended_from_outside_is_ungraded_and_not_zero': r'forked',
    'test_checks_parameters::test_a_mistake_with_the_rate_fails_only_the_check_of_the_rate': (
        r'OneBehind-.*'
    ),
    'test_checks_parameters::test_a_mistake_with_refusals_fails_only_the_check_of_refusals': (
        r'Corrects-.*'
    ),
    'test_checks_node_commands::test_each_mistake_in_a_command_line_is_named': r'-r __ns:=/right',
    'test_checks_stamps::test_stamps_of_the_computers_clock_fail_on_either_clock': (
        r'WallStamp-simulated'
    ),
    'test_checks_relays::test_a_message_with_a_changed_field_fails_and_the_field_is_named': (
        r'Stamps-.*'
    ),
    'test_checks_relays::test_a_subscription_with_an_incompatible_qos_profile_is_named': r'10-.*',
    'test_checks_clock::test_a_timer_is_judged_exactly_on_the_robots_clock': r'five_hz-.*',
    'test_checks_clock::test_a_node_is_alive_on_wall_time_after_a_check': r'five_hz',
    'test_checks_clock::test_a_node_is_alive_after_a_check_that_was_cut_short': (
        r'KeyboardInterrupt'
    ),
    # the setup of this environment was a test of pip or uv, too
    'test_course_setup::test_the_real_installers_set_up_a_working_environment': r'uv',
    'test_ros2_streams::test_echo_ended_by_a_signal_at_any_moment_leaves_no_node_on_the_graph': (
        r'2'
    ),
    'test_dask_backend::test_a_worker_that_differs_from_this_machine_grades_nothing': (
        r'environment0-.*'
    ),
    'test_ros2_run::test_a_signal_reaches_the_executable_once': (
        r'(the process|both)-2|its group-15'
    ),
    'test_kernel_exits::test_an_answer_that_ends_its_kernel_during_a_check_fails': (
        r'forked-9|started-15'
    ),
    'test_validate::test_a_cell_that_does_not_return_is_given_up_and_not_called_wrong': r'a cell',
    'test_validate::test_a_damaged_notebook_is_validated_as_far_as_possible': (
        r'take_a_check_away-.*'
    ),
    'test_validate::test_work_that_loses_points_is_not_promised_full_points': (
        r'a publisher without a stamp'
    ),
    'test_doctor_faults::test_a_publisher_out_of_reach_is_reported_and_its_fix_works': (
        r'environment1-.*'
    ),
    'test_checks_actions_nowhere::test_an_arm_that_gets_nowhere_fails_with_the_cause': (
        r'NeverEnds-.*'
    ),
    'test_checks_parameters::test_an_honest_way_passes': r'Adjustable',
    'test_checks_stamps::test_stamps_of_the_nodes_clock_pass_and_use_sim_time_is_reset': (
        r'SteadyClock'
    ),
    'test_checks_topics::test_silence_is_explained': r'callback_raises-.*',
    'test_testing::test_a_file_that_cannot_be_imported_is_named_and_not_run_again': (
        r'def test_a.*'
    ),
    'test_ros2_notebook::test_an_interrupt_ends_a_cell_and_leaves_nothing_behind': r'ros2 run .*',
    'test_synthetic_class::test_variations_of_a_sample_change_nothing_that_is_graded': (
        r'0[34]_.*-pass-[a-h].*'
    ),
}


def mark_slow(items: list[pytest.Item]) -> None:
    """Mark as slow the cases of tests that only `--slow` runs.

    Raises pytest.UsageError if the table leaves no case of a test for an ordinary run.
    """
    cases = defaultdict(list)
    for item in items:
        name, bracket, parameters = item.name.partition('[')
        if bracket:
            test = f'{item.path.stem}::{name}'
            cases[test].append((item, parameters.removesuffix(']')))
    lost = []
    for test, its_cases in cases.items():
        kept = _chosen(test, its_cases)
        if not kept:
            lost.append(test)
        for item, _ in its_cases:
            if item not in kept:
                item.add_marker('slow')
    if len(items) > len(ORDINARY) and lost:
        raise pytest.UsageError(f'tests/ordinary.py takes nothing of {", ".join(sorted(lost))}')


def _chosen(test: str, cases: list[tuple[pytest.Item, str]]) -> list[pytest.Item]:
    """Return the cases of a test that an ordinary run takes."""
    if test in ORDINARY:
        return [item for item, which in cases if re.fullmatch(ORDINARY[test], which)]
    faster = [item for item, _ in cases if not item.get_closest_marker('slow')]
    if any(item.get_closest_marker('starts') for item in faster):
        return faster[:FEW]
    return [item for item, _ in cases]
