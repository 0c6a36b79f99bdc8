"""The data fields of components in a recording: what a tick keeps, how a file holds them, and how they are read."""

#: topics of the data fields, and the type of their messages
FIELDS, FIELDS_TYPE = "/morse/fields", "std_msgs/msg/UInt8MultiArray"
#: named strings of a channel of fields: the component, its class, and the declarations of its fields
COMPONENT, CLASS, DECLARED = "morse.component", "morse.class", "morse.fields"
