"""The sources of the formulas of components."""

SOURCES = {
    "Accelerometer": "Newtonian kinematics; differences of velocity over a tick",
    "Airspeed": "Bernoulli's equation; density of the air at sea level by ISO 2533:1975",
    "ADIS16448": "data sheet of the ADIS16448 (Analog Devices); the terms are those of IEEE Std 952-1997",
    "BMI088": "data sheet of the BMI088 (Bosch Sensortec); the terms are those of IEEE Std 952-1997",
    "Barometer": "ISO 2533:1975, Standard Atmosphere: the layer up to 11 km",
    "Drag": "quadratic drag, F = 1/2 ρ v² c A, with C = 1/2 ρ c A",
    "GPS": "WGS84 ellipsoid: NGA.STND.0036",
    "IMU": "specific force; noise in the terms of IEEE Std 952-1997",
    "Magnetometer": "World Magnetic Model of NOAA/NCEI and BGS, 2010 to 2025; computed by pygeomag",
    "QuadrotorDynamicControl": "thrust and drag of a rotor grow with the square of its speed (momentum theory)",
    "SteerForce": "Ackermann steering: single-track model without slip",
    "VN100": "data sheet of the VN-100 (VectorNav); the terms are those of IEEE Std 952-1997",
    "WheelEncoders": "incremental encoder: angle divided by the step, rounded down",
}
