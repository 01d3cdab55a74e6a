"""The actuator as it is: parameters, leaf spring (3)-(4), dynamics (1)-(2), drives and sensors."""
