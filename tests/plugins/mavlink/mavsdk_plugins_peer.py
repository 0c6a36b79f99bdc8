"""MAVSDK's plugins, each with calls and default settings; prints ``{call: [result, seconds]}`` as JSON."""

import json
import os
import sys
import tempfile
import threading
import time
from importlib import import_module

from mavsdk import ComponentType, Configuration, Mavsdk

sdk = Mavsdk(Configuration.create_with_component_type(ComponentType.GROUND_STATION))
sdk.add_any_connection(f"udpin://127.0.0.1:{sys.argv[1]}")
system = sdk.first_autopilot(60.0)
results: dict = {}
LIMIT = 20.0


def plugin(name):
    module = import_module(f"mavsdk.plugins.{name}")
    return module, getattr(module, "".join(word.capitalize() for word in name.split("_")))(system)


def call(name, function, *values):
    """Call, in a thread of its own: a call of MAVSDK that gets no answer may never return."""
    answers = []

    def work():
        try:
            answers.append([getattr(function(*values), "name", "SUCCESS"), time.monotonic() - begin])
        except Exception as error:
            answers.append([getattr(getattr(error, "result", None), "name", repr(error)), time.monotonic() - begin])

    begin = time.monotonic()
    thread = threading.Thread(target=work, daemon=True)
    thread.start()
    thread.join(LIMIT)
    results[name] = answers[0] if answers else ["NO ANSWER", LIMIT]


def call_async(name, function, *values):
    """Call a function that has only a form with a callback; its last result."""
    ended, codes = threading.Event(), []
    begin = time.monotonic()

    def told(result, *_):
        codes.append(result.name)
        if result.name not in ("NEXT", "IN_PROGRESS"):
            ended.set()

    function(*values, told)
    ended.wait(LIMIT)
    results[name] = [codes[-1] if codes else "NO ANSWER", time.monotonic() - begin]


def wait_for(condition):
    end = time.monotonic() + 60.0
    while not condition() and time.monotonic() < end:
        time.sleep(0.1)


m, action = plugin("action")
call("action.arm", action.arm)
call("action.disarm", action.disarm)
for name in ("reboot", "shutdown", "transition_to_fixedwing", "get_takeoff_altitude"):
    call(f"action.{name}", getattr(action, name))
call("action.set_actuator", action.set_actuator, 1, 0.5)
call("action.set_gps_global_origin", action.set_gps_global_origin, 47.0, 8.0, 500.0)
call("action.do_orbit", action.do_orbit, 5.0, 1.0, m.OrbitYawBehavior(0), 47.39, 8.54, 500.0)

m, one = plugin("calibration")
for name in ("gyro", "accelerometer", "magnetometer", "level_horizon", "gimbal_accelerometer"):
    call_async(f"calibration.{name}", getattr(one, f"calibrate_{name}_async"))

m, camera = plugin("camera")
wait_for(lambda: camera.camera_list().cameras)
taken = []
camera.subscribe_capture_info(lambda information, *_: taken.append(information))
number = camera.camera_list().cameras[0].component_id


def has_status():
    try:
        return camera.get_storage(number)
    except Exception:  # it has not asked yet
        return None


wait_for(has_status)
for name, values in {
    "take_photo": (), "start_photo_interval": (0.5,), "stop_photo_interval": (), "set_mode": (m.Mode.PHOTO,),
    "list_photos": (m.PhotosRange.ALL,), "get_storage": (), "start_video": (), "start_video_streaming": (1,),
    "zoom_in_start": (), "track_point": (0.5, 0.5, 0.1), "focus_auto": (), "reset_settings": (),
}.items():  # fmt: skip
    call(f"camera.{name}", getattr(camera, name), number, *values)
wait_for(lambda: taken)

m, one = plugin("ftp")
call("ftp.list_directory", one.list_directory, "/")
call("ftp.list_directory, none", one.list_directory, "/nothere")
call("ftp.create_directory", one.create_directory, "/x")
call("ftp.remove_file", one.remove_file, "/x")
call("ftp.rename", one.rename, "/x", "/y")
path = taken[0].file_url.split("://")[1]
with tempfile.TemporaryDirectory() as folder:
    for burst in (False, True):
        call_async(f"ftp.download, burst {burst}", one.download_async, path, folder, burst)
        file = f"{folder}/{path.rpartition('/')[2]}"
        with open(file, "rb") as content:
            results[f"photo, burst {burst}"] = [content.read(3).hex(), 0.0]
        call("ftp.are_files_identical", one.are_files_identical, file, path)
    call_async("ftp.upload", one.upload_async, file, "/")
call("camera.format_storage", camera.format_storage, number, 1)

m, one = plugin("geofence")
corners = [m.Point(47.3977 + a * 1e-3, 8.5456 + b * 1e-3) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
circle = m.Circle(m.Point(47.3977, 8.5456), 50.0, m.FenceType.INCLUSION)
call("geofence.upload", one.upload_geofence, m.GeofenceData([m.Polygon(corners, m.FenceType.INCLUSION)], [circle]))
call("geofence.download", one.download_geofence)
call("geofence.clear", one.clear_geofence)

m, one = plugin("gimbal")
wait_for(lambda: one.gimbal_list().gimbals)
number = one.gimbal_list().gimbals[0].gimbal_id
call("gimbal.take_control", one.take_control, number, m.ControlMode.PRIMARY)
call("gimbal.set_angles", one.set_angles, number, 0.0, -20.0, 30.0, m.GimbalMode(0), m.SendMode(0))
call("gimbal.set_angular_rates", one.set_angular_rates, number, 0.0, 5.0, 5.0, m.GimbalMode(0), m.SendMode(0))
call("gimbal.set_roi_location", one.set_roi_location, number, 47.3978, 8.5456, 480.0)
call("gimbal.release_control", one.release_control, number)

m, one = plugin("log_files")
call("log_files.get_entries", one.get_entries)
m, one = plugin("log_streaming")
call("log_streaming.start", one.start_log_streaming)
m, one = plugin("failure")
call("failure.inject", one.inject, m.FailureUnit(1), m.FailureType(1), 0)
m, one = plugin("winch")
call("winch.hold", one.hold, 1)
m, one = plugin("gripper")
call("gripper.grab", one.grab, 1)
m, one = plugin("transponder")
call("transponder.set_rate", one.set_rate_transponder, 1.0)
m, one = plugin("info")
call("info.get_version", one.get_version)
call("info.get_identification", one.get_identification)
m, one = plugin("shell")
said = []
one.subscribe_receive(lambda data, *_: said.append(str(data)))
for _ in range(3):  # MAVSDK does not repeat what UDP loses
    if not said:
        call("shell.send", one.send, "help\n", m.ShellDevice(0) if hasattr(m, "ShellDevice") else 10)
        wait_for(lambda: said)
results["shell"] = ["SAID" if said else "SILENT", 0.0]

m, one = plugin("param")
call("param.get_param_float", one.get_param_float, "MIS_TAKEOFF_ALT")
call("param.set_param_float", one.set_param_float, "MIS_TAKEOFF_ALT", 4.0)
call("param.set_param_float, too large", one.set_param_float, "MIS_TAKEOFF_ALT", 1e9)
call("param.get_param_int", one.get_param_int, "NAV_DLL_ACT")
call("param.set_param_int", one.set_param_int, "NAV_DLL_ACT", 2)
call("param.get_param_float, none", one.get_param_float, "NOT_THERE")
call("param.get_all_params", one.get_all_params)

m, one = plugin("mission_raw")
rally = [m.MissionItem(0, 3, 5100, 0, 1, 0, 0, 0, 0, 473978000, 85456000, 5.0, 2)]
call("mission_raw.upload_rally_points", one.upload_rally_points, rally)
call("mission_raw.download_rallypoints", one.download_rallypoints)

m, one = plugin("telemetry")
for name in ("attitude_quaternion", "odometry", "altitude", "position", "distance_sensor"):
    call(f"telemetry.set_rate_{name}", getattr(one, f"set_rate_{name}"), 5.0)
call("telemetry.get_gps_global_origin", one.get_gps_global_origin)

m, one = plugin("follow_me")
call("action.arm again", action.arm)
call("action.takeoff", action.takeoff)
telemetry = plugin("telemetry")[1]
wait_for(lambda: telemetry.position().relative_altitude_m > 1.5)
call("follow_me.start", one.start)
wait_for(one.is_active)
call("follow_me.set_target_location", one.set_target_location, m.TargetLocation(47.39775, 8.5456, 490.0, 0, 0, 0))
call("follow_me.stop", one.stop)

m, one = plugin("offboard")
call("offboard.set_position_ned", one.set_position_ned, m.PositionNedYaw(0.0, 0.0, -3.0, 0.0))
call("offboard.start", one.start)
call("offboard.stop", one.stop)
m, one = plugin("manual_control")
one.set_manual_control_input(0.0, 0.0, 0.5, 0.0)
call("manual_control.start_position_control", one.start_position_control)
call("action.kill", action.kill)
print(json.dumps(results), flush=True)
os._exit(0)
