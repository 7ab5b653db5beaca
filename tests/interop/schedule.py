"""When which check runs: those of which nothing is said here are Plan(). The seconds are those of a quiet machine with two cores; every
run shows them, and what of them was a processor's.
A check runs in `./check` unless it is marked (`@tier`) or judges time (`alone`); those run in `./check --all`.
"""
from runner import Plan

TIERS = ["check", "long", "browser", "machine"]
WAITING = 12  # checks at one time that hardly compute, besides those that do
LIMIT = 900   # s: a check that takes longer fails


def _waits(seconds):
    """Silence on a bus, time-outs, pauses of people: at most a sixth of its time is a processor's."""
    return Plan(seconds, waits=True)


PLANS = {
    "lss_command_makes_a_network_of_unconfigured_devices": _waits(221),
    "commands_join_socketcan": _waits(182),
    "lss_command_finds_and_numbers_foreign_devices": _waits(169),
    "the_page_of_commands_shows_what_lss_prints": _waits(180),
    "the_page_of_commands_shows_what_they_print": _waits(40),
    "the_tool_scans_and_sends_sdos": _waits(131),
    "configure_reaches_an_rj71cn91s_network": _waits(130),
    "a_late_answer_to_a_scan_begins_it_again": _waits(77),
    "gateway_configures_devices_by_lss": _waits(68),
    "a_replay_says_when_a_bus_takes_no_more_frames": _waits(64),
    "killed_while_saving_leaves_old_or_new_settings": _waits(38),
    "the_lift_program_controls_a_plant_in_real_time": _waits(32),
    "the_servo_example_of_the_as_fcopm_runs_as_its_page_shows": _waits(22),
    "a_replay_loses_nothing_to_a_plant_that_stands_still": _waits(21),
    "a_replay_on_a_bus_without_another_node_ends_with_an_error": _waits(20),
    "master_tells_why_a_slave_does_not_boot": _waits(20),
    "lss_search_over_bit_rates": _waits(40),
    "a_running_network_is_adopted_and_runs_again_from_its_project": _waits(100),
    "a_network_is_adopted_from_xdd_files": _waits(50),
    "a_wrong_node_id_and_downloads_of_an_as_fcopm_are_shown_in_sr825": _waits(13),
    "example_program_of_the_fx3u_can_does_what_the_function_blocks_do": _waits(11),
    "idle_plc_clients_give_way_and_it_is_said": _waits(11),
    "scan_finds_an_fx3u_can_as_the_configuration_tool_does": _waits(140),
    "the_page_of_projects_shows_what_the_commands_print": _waits(50),
    "example_program_does_what_the_function_blocks_do": _waits(9),
    "errors_remain_when_the_table_has_gone": _waits(8),
    "npm_canopen_is_a_slave_of_the_rj71cn91": _waits(7),
    "scan_finds_the_nodes_of_the_first_plant": _waits(80),
    "a_bus_becomes_a_plant": _waits(45),
    "master_boots_a_network_without_a_plc": _waits(15),
    "npm_canopen_is_a_slave_of_the_fx3u_can": _waits(7),
    "example_starts_an_me3can1_q_up": _waits(7),
    "a_replay_waits_for_a_bus_that_takes_no_frames_for_a_time": _waits(7),
    "npm_canopen_as_lss_master_configures_our_devices": _waits(6),
    "terminals_that_are_none_and_colour_that_is_not_wanted": _waits(6),
    "a_cpp_program_on_the_rooms_boots_a_network": _waits(5),
    "a_forced_input_arrives_in_the_plc_as_the_page_shows": _waits(5),
    "monitor_shows_and_records_what_is_on_a_bus": _waits(5),
    "a_stopped_terminal_does_not_stop_the_plant": _waits(5),
    "ctrl_z_gives_the_terminal_back": _waits(4),
    "the_vendors_operations_on_an_as_fcopm_are_commands": _waits(4),
    "an_unread_output_does_not_stop_the_plant": _waits(4),

    # They compute. In the virtual machine a processor is emulated.
    "plants_on_socketcan": Plan(26),
    "a_peer_without_pause_does_not_hold_a_command": Plan(7),
    "gateway_ends_a_client_that_takes_no_events": Plan(19),
    "socketcan_says_what_the_controller_does": Plan(12),
    "a_bus_without_another_node_is_told": _waits(30),
    "npm_canopen_is_a_slave_of_the_as_fcopm": Plan(9),
    "the_list_of_parts_names_every_library": Plan(8),
    "tshark_agrees_with_our_decoder_on_our_plants": Plan(7),
    "the_site_of_the_documentation_is_made_without_a_broken_link": Plan(6),
    "a_project_of_its_own_finds_the_installed_library": Plan(5, shares="installation"),
    "the_python_package_is_installed_with_the_program": Plan(3, shares="installation"),

    "page_workflows_in_chromium": Plan(120),
    "page_screens_in_chromium": Plan(90),
    "page_pictures_are_those_of_the_documentation": Plan(50),
    "page_tests": Plan(25),

    # They judge how fast the program is.
    "a_client_that_left_does_not_keep_a_bus_busy_where_nobody_acknowledges": Plan(alone=True),
    "a_client_that_left_does_not_keep_the_bus_busy": Plan(alone=True),
    "a_suspended_process_is_not_the_machines_fault": Plan(alone=True),
    "clients_of_a_quiet_bus_make_no_lag": Plan(alone=True),
    "sixty_four_clients_find_their_own_words_and_the_bus_loses_nothing": Plan(alone=True),
    "web_hostile_clients": Plan(alone=True),
    "web_fifty_pages_of_a_full_bus": Plan(alone=True),
    # Answers that come too late lead a scan by LSS astray.
    "web_scan_lss_and_sdo": Plan(alone=True),
}

_REASONS = {"browser": "Chromium computes for minutes", "machine": "the processor of the virtual machine is emulated",
            "long": "it judges how fast the program is, or takes minutes"}


def plan_of(function):
    return PLANS.get(function.__name__, Plan())


def tier_of(function):
    if hasattr(function, "tier"):
        return function.tier
    return "long" if plan_of(function).alone else "check"


def reason_of(function):
    return _REASONS[tier_of(function)]
