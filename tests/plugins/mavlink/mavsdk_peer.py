"""MAVSDK, which shares no code with pymavlink, listens to a vehicle; prints its telemetry as JSON."""

import json
import sys
import time

from mavsdk import ComponentType, Configuration, Mavsdk
from mavsdk.plugins.telemetry import Telemetry

sdk = Mavsdk(Configuration.create_with_component_type(ComponentType.GROUND_STATION))
sdk.add_any_connection(f"udpin://127.0.0.1:{sys.argv[1]}")
telemetry = Telemetry(sdk.first_autopilot(40.0))
seen: dict = {}
end = time.monotonic() + 40.0
while time.monotonic() < end and len(seen) < 4:
    time.sleep(0.1)
    attitude, battery = telemetry.attitude_euler(), telemetry.battery()
    place, gps = telemetry.position_velocity_ned(), telemetry.raw_gps()
    if attitude.yaw_deg:
        seen["yaw"] = attitude.yaw_deg
    if battery.remaining_percent > 0.0:
        seen["battery"] = battery.remaining_percent
    if place.position.down_m:
        seen["down"] = place.position.down_m
    if gps.latitude_deg > 1.0:
        seen["gps"] = [gps.latitude_deg, gps.longitude_deg, gps.absolute_altitude_m]
print(json.dumps(seen))
