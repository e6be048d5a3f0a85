"""Definitions as recorders write them."""

from typing import Final

SEPARATOR: Final = "=" * 80
CONTACTS_TEXT: Final = f"""\
Header header                                   # stamp
gazebo_msgs/ContactState[] states            # array of geom pairs in contact

{SEPARATOR}
MSG: std_msgs/Header
# Standard metadata for higher-level stamped data types.
uint32 seq
#Two-integer timestamp
time stamp
string frame_id

{SEPARATOR}
MSG: gazebo_msgs/ContactState
string info                                   # text info on this contact
string collision1_name                        # name of contact collision1
string collision2_name                        # name of contact collision2
geometry_msgs/Wrench[] wrenches               # list of forces/torques
geometry_msgs/Wrench total_wrench             # sum of forces/torques in every DOF
geometry_msgs/Vector3[] contact_positions     # list of contact position
geometry_msgs/Vector3[] contact_normals       # list of contact normals
float64[] depths                              # list of penetration depths

{SEPARATOR}
MSG: geometry_msgs/Wrench
# This represents force in free space, separated into
# its linear and angular parts.
Vector3  force
Vector3  torque

{SEPARATOR}
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
"""
STAMPED_IDL: Final = """\
module builtin_interfaces {
  module msg {
    @verbatim (language="comment", text=
      "Time indicates a specific point in time.")
    struct Time {
      @verbatim (language="comment", text="The seconds component.")
      int32 sec;
      uint32 nanosec;
    };
  };
};
module demo {
  module msg {
    typedef double double__3[3];
    struct Stamped {
      builtin_interfaces::msg::Time stamp;
      @unit (value="m")
      double__3 position;
      sequence<double> distances;
      sequence<string, 4> names;
      string<10> label;
      boolean valid;
    };
  };
};
"""
