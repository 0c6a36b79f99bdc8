"""Names for data whose form is declared at run time: by components, by types of messages, by users.

A type checker cannot know the types of their values. `morse.core.validation` checks them against the declarations where
they come in.
"""

from __future__ import annotations

from typing import Any, TypeAlias

#: the value of a field, a slot, a property or an option, which has the type of its declaration
Value: TypeAlias = Any
#: values of data fields, by name: ``local_data``, commands, measurements
Fields: TypeAlias = dict[str, Value]
#: properties of an object, by name: numbers, texts, lists and others that scripts and files set
Properties: TypeAlias = dict[str, object]
#: options that scripts give to streams, modifiers and managers
Options: TypeAlias = dict[str, Any]
#: the state of a part as plain data, see `morse.core.state`
StateData: TypeAlias = dict[str, object]
#: a message of ROS: names of its fields to numbers, texts, arrays, lists and messages
RosMessage: TypeAlias = dict[str, object]
#: a message of ROS that was decoded: its values have the types that the definition of its type declares
DecodedMessage: TypeAlias = dict[str, Any]
#: an object in JSON
JsonObject: TypeAlias = dict[str, object]
